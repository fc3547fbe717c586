"""Curved shapes: surfaces of revolution, tubes, spheres, tori and free surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .mesh import Array, Mesh, merge, normalize


def lathe(profile: ArrayLike, segments: int = 64, crease: float = 40.0) -> Mesh:
    """Turns a profile of (radius, height) points about the y axis.

    Going up, the outside is to the right of the profile: a solid starts on
    the axis below, rises outside, and ends on the axis. Normals are smooth
    except where the profile bends by more than `crease` degrees. u runs once
    around, v along the profile from 1 to 0. Tangents follow u.
    """
    points = np.asarray(profile, dtype=float)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    outward = np.column_stack([steps[:, 1], -steps[:, 0]]) / lengths[:, None]
    along = np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
    bands: list[Mesh] = []
    start = 0
    for end in range(1, len(points)):
        last = end == len(points) - 1
        if last or outward[end - 1] @ outward[end] < np.cos(np.radians(crease)):
            bands.append(_band(points[start : end + 1], outward[start:end], along[start : end + 1], segments))
            start = end
    return merge(bands)


def _band(points: Array, outward: Array, along: Array, segments: int) -> Mesh:
    """A smooth stretch of a lathe profile turned about the axis."""
    slopes = np.concatenate([outward[:1], outward[:-1] + outward[1:], outward[-1:]])
    # On the axis a smooth surface is level; the slope of the last segment would leave a pit.
    for index in (0, len(points) - 1):
        if points[index, 0] == 0.0 and len(points) > 2:
            slopes[index] = [0.0, np.sign(slopes[index, 1]) or 1.0]
    slopes = normalize(slopes)
    angles = 2 * np.pi * (np.arange(segments + 1) % segments) / segments
    cosine, sine = np.cos(angles), np.sin(angles)

    def turned(radial: Array, height: Array) -> Array:
        ring = [np.outer(radial, cosine), np.repeat(height[:, None], segments + 1, 1), np.outer(radial, sine)]
        return np.stack(ring, axis=-1).reshape(-1, 3)

    count = len(points)
    uvs = np.stack(np.broadcast_arrays(1 - np.arange(segments + 1) / segments, 1 - along[:, None]), -1).reshape(-1, 2)
    tangent = np.column_stack([sine, np.zeros(segments + 1), -cosine, np.ones(segments + 1)])
    row, column = np.meshgrid(np.arange(count - 1), np.arange(segments), indexing="ij")
    a = (row * (segments + 1) + column).reshape(-1)
    up, beside = a + segments + 1, a + 1
    lower = np.column_stack([a, up, beside])[np.repeat(points[:-1, 0] > 0.0, segments)]
    upper = np.column_stack([up, up + 1, beside])[np.repeat(points[1:, 0] > 0.0, segments)]
    return Mesh(
        turned(points[:, 0], points[:, 1]),
        turned(slopes[:, 0], slopes[:, 1]),
        uvs,
        np.concatenate([lower, upper]),
        np.tile(tangent, (count, 1)),
    )


def sphere(radius: float, segments: int = 64, rings: int = 32) -> Mesh:
    """A sphere about the origin, poles on the y axis."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    profile = np.column_stack([np.cos(angles), np.sin(angles)]) * radius
    profile[[0, -1], 0] = 0.0
    ball = lathe(profile, segments, 180.0)
    return Mesh(ball.positions, normalize(ball.positions), ball.uvs, ball.triangles, ball.tangents)


def cylinder(radius: float, height: float, segments: int = 32) -> Mesh:
    """A closed upright cylinder that stands on the origin."""
    return lathe([(0, 0), (radius, 0), (radius, height), (0, height)], segments)


def disk(radius: float, segments: int = 48) -> Mesh:
    """A flat disk at the origin, facing up."""
    return lathe([(radius, 0), (0, 0)], segments)


def smooth_profile(points: ArrayLike, steps: int = 8) -> Array:
    """A Catmull–Rom curve (centripetal) through the points, with `steps` pieces for each pair."""
    control = np.asarray(points, dtype=float)
    padded = np.vstack([2 * control[0] - control[1], control, 2 * control[-1] - control[-2]])
    curve = [control[:1]]
    for index in range(len(control) - 1):
        p = padded[index : index + 4]
        knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(p, axis=0), axis=1)))])
        t = np.linspace(knots[1], knots[2], steps + 1)[1:, None]

        first = [_between(p[i], p[i + 1], knots[i], knots[i + 1], t) for i in range(3)]
        second = [_between(first[i], first[i + 1], knots[i], knots[i + 2], t) for i in range(2)]
        curve.append(_between(second[0], second[1], knots[1], knots[2], t))
    return np.concatenate(curve)


def _between(a: Array, b: Array, start: float, end: float, t: Array) -> Array:
    """The line that is `a` at time `start` and `b` at time `end`, at times `t`."""
    return (a * (end - t) + b * (t - start)) / (end - start)


def tube(path: ArrayLike, radius: float | Sequence[float], segments: int = 16, closed: bool = False) -> Mesh:
    """A round tube along a path, with flat caps unless the path closes on itself.

    The frame is carried along without twist (parallel transport), so the
    path may bend any way.
    """
    points = np.asarray(path, dtype=float)
    radii = np.broadcast_to(np.asarray(radius, dtype=float), len(points))
    ahead = np.roll(points, -1, 0) - points if closed else np.gradient(points, axis=0)
    tangents = normalize(ahead + np.roll(ahead, 1, 0) if closed else ahead)
    side = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    rings = []
    for tangent in tangents:
        side = normalize(side - tangent * (side @ tangent))
        rings.append((side, np.cross(tangent, side)))
    angles = 2 * np.pi * (np.arange(segments + 1) % segments) / segments
    normals = np.array([np.outer(np.cos(angles), a) + np.outer(np.sin(angles), b) for a, b in rings])
    grid = points[:, None] + normals * radii[:, None, None]
    if closed:
        grid, normals = np.concatenate([grid, grid[:1]]), np.concatenate([normals, normals[:1]])
    body = _patch(grid, normals).reversed()
    body = Mesh(body.positions, -body.normals, body.uvs, body.triangles)
    if closed:
        return body
    return merge([body, _cap(grid[0], -tangents[0]), _cap(grid[-1], tangents[-1])])


def _cap(ring: Array, normal: Array) -> Mesh:
    """A fan that closes the end of a tube, facing `normal`."""
    rim = ring[:-1]
    count = len(rim)
    positions = np.vstack([rim, rim.mean(axis=0)])
    fan = np.column_stack([np.full(count, count), np.arange(count), (np.arange(count) + 1) % count])
    facing = np.cross(rim[0] - positions[count], rim[1] - positions[count]) @ normal > 0
    uvs = np.zeros((count + 1, 2))
    return Mesh(positions, np.tile(normal, (count + 1, 1)), uvs, fan if facing else fan[:, ::-1])


def torus(major: float, minor: float, segments: int = 48, sides: int = 16) -> Mesh:
    """A ring in the xz plane about the origin."""
    angles = 2 * np.pi * np.arange(segments) / segments
    path = np.column_stack([np.cos(angles), np.zeros(segments), np.sin(angles)]) * major
    return tube(path, minor, sides, closed=True)


def surface(grid: ArrayLike) -> Mesh:
    """A smooth sheet through a (rows, columns, 3) grid, seen from its front: rows go down, columns right.

    u and v run from 0 to 1 along columns and rows.
    """
    points = np.asarray(grid, dtype=float)
    down, right = np.gradient(points, axis=0), np.gradient(points, axis=1)
    return _patch(points, normalize(np.cross(down, right)))


def _patch(grid: Array, normals: Array) -> Mesh:
    """Triangles over a grid of points whose rows go down and columns right."""
    rows, columns = grid.shape[:2]
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (row * columns + column).reshape(-1)
    b, c, d = a + columns, a + columns + 1, a + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    uvs = np.column_stack([u.reshape(-1), v.reshape(-1)])
    return Mesh(grid.reshape(-1, 3), normals.reshape(-1, 3), uvs, triangles)

"""A glTF file by Blender and Cycles, from a Python that has bpy: cycles_peer.py FILE OUT.exr SIZE SPP ASKED

ASKED is JSON: sky, sun, angle, direction and camera, in the axes of glTF; without camera, one is made that sees all.
Prints Blender's version and the camera.
"""

import json
import math
import sys

import bpy
from mathutils import Vector

YFOV = math.radians(35)


def load(file: str) -> None:
    """The file alone at the start of its animations, without its own cameras and lights."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=file)
    bpy.context.scene.frame_set(0)
    for thing in [o for o in bpy.data.objects if o.type in {"CAMERA", "LIGHT"}]:
        bpy.data.objects.remove(thing)


def frame() -> dict[str, list[float]]:
    """A camera a little above and beside the front that sees all."""
    drawn = bpy.context.evaluated_depsgraph_get().object_instances
    corners = [i.matrix_world @ Vector(c) for i in drawn if i.object.type == "MESH" for c in i.object.bound_box]
    low = Vector(map(min, *corners))
    high = Vector(map(max, *corners))
    centre, radius = (low + high) / 2, (high - low).length / 2
    towards = Vector((0.35, -1.0, 0.3)).normalized()
    position = centre + towards * radius / math.sin(YFOV / 2)
    return {"position": to_gltf(position), "target": to_gltf(centre)}


def to_gltf(v: Vector) -> list[float]:
    """From Z up to Y up."""
    return [v.x, v.z, -v.y]


def from_gltf(v: list[float]) -> Vector:
    """From Y up to Z up."""
    return Vector((v[0], -v[2], v[1]))


def light(sky: float, sun: float, angle: float, direction: list[float]) -> None:
    """A uniform sky of this radiance and a sun of this illuminance, so many degrees wide."""
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = sky
    bpy.context.scene.world = world
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = sun, math.radians(angle)
    thing = bpy.data.objects.new("sun", lamp)
    thing.rotation_euler = from_gltf(direction).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)


def render(out: str, size: int, spp: int, camera: dict[str, list[float]]) -> None:
    """Renders linear light to an EXR."""
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle_y = "VERTICAL", math.radians(camera["yfov"]) if "yfov" in camera else YFOV
    lens.clip_start, lens.clip_end = 1e-4, 1e6
    thing = bpy.data.objects.new("camera", lens)
    position, target = from_gltf(camera["position"]), from_gltf(camera["target"])
    thing.location = position
    thing.rotation_euler = (target - position).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)
    scene = bpy.context.scene
    scene.camera = thing
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = spp, False, False
    scene.cycles.max_bounces = scene.cycles.transparent_max_bounces = 16
    scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = scene.cycles.transmission_bounces = 16
    scene.cycles.sample_clamp_indirect = scene.cycles.sample_clamp_direct = 0
    scene.cycles.blur_glossy = 0
    scene.cycles.filter_width, scene.cycles.pixel_filter_type = 1.0, "BOX"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


def main() -> None:
    """Renders, and says how."""
    file, out, size, spp, asked = sys.argv[1:]
    load(file)
    wanted = json.loads(asked)
    camera = wanted.get("camera") or frame()
    light(wanted["sky"], wanted["sun"], wanted["angle"], wanted["direction"])
    render(out, int(size), int(spp), camera)
    print("made", json.dumps({"blender": bpy.app.version_string, "camera": camera}))


if __name__ == "__main__":
    main()

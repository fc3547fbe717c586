"""Ajar beside other renderers: error over CPU time on the same geometry, materials and lights.

    cargo build --release
    pip install mitsuba pyluxcore OpenImageIO numpy pillow matplotlib
    python tools/bench/peers door-ajar window-room FOLDER… [--seconds 15,30,60] [--out out/peers]

A name is a scene of this project, made comparable by `make.py`; a folder holds a comparable scene already (`make.py`
says how it looks) with a converged `reference.exr` and perhaps `mask_dielectric.npy`, the pixels that see glass
first. Where there is no reference, Ajar renders one for `--reference` CPU seconds.

Every renderer runs on one thread. The error is the mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels, and the
same of blocks of 8 x 8 pixels. Images stay in the output folder; `results.json`, `results.md` and `curves.svg` say
what was found.
"""

import argparse
import json
import resource
import subprocess
import sys
from pathlib import Path

import make
import numpy as np

HERE = Path(__file__).resolve().parent
AJAR = {f"ajar {name}": ["ajar", name] for name in ("ajar", "mlt", "path", "bdpt")}
MITSUBA = {
    "mitsuba path": ["mitsuba_peer.py", "llvm_ad_rgb", "path"],
    "mitsuba ptracer": ["mitsuba_peer.py", "llvm_ad_rgb", "ptracer"],
    "mitsuba path, scalar": ["mitsuba_peer.py", "scalar_rgb", "path"],
}
LUXCORE = {
    "luxcore path": ["luxcore_peer.py", "PATHCPU", "METROPOLIS"],
    "luxcore bidir": ["luxcore_peer.py", "BIDIRCPU", "METROPOLIS"],
}
ALL = AJAR | MITSUBA | LUXCORE


def blocks(image, side=8):
    height, width, channels = image.shape
    cut = image[: height // side * side, : width // side * side]
    return cut.reshape(height // side, side, width // side, side, channels).mean((1, 3))


def relative_error(image, reference):
    return float(((image - reference) ** 2 / (reference**2 + 0.01)).mean())


def errors(image, folder):
    reference = make.read_rgb(folder / "reference.exr").astype(np.float64)
    found = {
        "error": relative_error(image, reference),
        "blocks": relative_error(blocks(image), blocks(reference)),
        "brightness": float(image.mean() / reference.mean()),
    }
    mask = folder / "mask_dielectric.npy"
    if mask.exists():
        outside = ~np.load(mask).astype(bool).reshape(image.shape[:2])
        found["outside glass"] = relative_error(image[outside], reference[outside])
    return found


def child_cpu():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def render_ajar(program, folder, integrator, seconds, exr, seed=0):
    """CPU seconds that an image of about as many took."""
    command = [program, "render", folder / "scene.toml", "-o", exr, "--integrator", integrator, "--seed", str(seed)]
    command += ["--threads", "1", "--float", "-q", "--stats-json", exr.with_suffix(".json")]
    before = child_cpu()
    subprocess.run([*command, "--time", f"{seconds}s"], check=True)
    return child_cpu() - before


def ensure_toml(folder):
    if not (folder / "scene.toml").exists():
        scene = json.loads((folder / "scene.json").read_text())
        (folder / "scene.toml").write_text(make.TOML.format(**scene["camera"], max_depth=scene["max_depth"]))


def run(label, folder, seconds, prefix, program):
    """Rows of what one renderer reached."""
    script, *arguments = ALL[label]
    rows = []
    if script == "ajar":
        for limit in seconds:
            exr = prefix.with_name(f"{prefix.name}-{limit:g}.exr")
            cpu = render_ajar(program, folder, arguments[0], limit, exr)
            rows.append({"renderer": label, "cpu": cpu, **errors(make.read_rgb(exr).astype(np.float64), folder)})
        return rows
    limits = ",".join(f"{limit:g}" for limit in seconds)
    command = [sys.executable, HERE / script, folder, *arguments, limits, prefix]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    for line in (json.loads(line) for line in lines if line.startswith("{")):
        image = np.load(f"{prefix}-{line['seconds']:g}.npy").astype(np.float64)
        rows.append({"renderer": label, "cpu": line["cpu"], **errors(image, folder)})
    return rows


def table(name, rows):
    """What was reached at the longest time, scaled to it by the inverse of the time."""
    last = max(row["cpu"] for row in rows)
    outside = any("outside glass" in row for row in rows)
    head = (
        f"| {name}, at {last:.0f} CPU s | relMSE | 8×8 blocks |"
        + (" outside glass |" if outside else "")
        + " brightness |"
    )
    lines = [head, "|" + "---|" * (head.count("|") - 1)]
    for label in dict.fromkeys(row["renderer"] for row in rows):
        row = [row for row in rows if row["renderer"] == label][-1]
        scale = row["cpu"] / last
        cells = [row["error"] * scale, row["blocks"] * scale]
        cells += [row["outside glass"] * scale] if outside else []
        numbers = " | ".join(f"{cell:.2g}" for cell in cells)
        lines.append(f"| {label} | {numbers} | {row['brightness']:.3f} |")
    return "\n".join(lines)


def curves(results, path):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    size = (4.2 * len(results) + 1.6, 4.2)
    figure, axes = plt.subplots(1, len(results), figsize=size, squeeze=False, layout="constrained")
    for axis, (name, rows) in zip(axes[0], results.items(), strict=True):
        for label in dict.fromkeys(row["renderer"] for row in rows):
            mine = [row for row in rows if row["renderer"] == label]
            ours = label.startswith("ajar")
            axis.plot(
                [row["cpu"] for row in mine],
                [row["error"] for row in mine],
                "o-" if ours else "s--",
                label=label,
                linewidth=1.8 if ours else 1.0,
                markersize=4,
            )
        axis.set(xscale="log", yscale="log", title=name, xlabel="CPU seconds", ylabel="relative mean squared error")
        axis.grid(True, which="major", alpha=0.3)
        axis.xaxis.set_minor_formatter("{x:g}")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="outside right center", fontsize=8)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--seconds", default="15,30,60", help="CPU seconds to stop at")
    parser.add_argument("--reference", type=float, default=1800, help="CPU seconds for a reference that is not there")
    parser.add_argument("--only", default="", help="renderers whose names hold one of these words, separated by commas")
    parser.add_argument("--out", type=Path, default=Path("out/peers"))
    parser.add_argument("--ajar", default="target/release/ajar")
    given = parser.parse_args()
    seconds, results = [float(s) for s in given.seconds.split(",")], {}
    given.out.mkdir(parents=True, exist_ok=True)
    for name in given.scenes:
        folder = Path(name)
        if not folder.is_dir():
            folder = given.out / name
            if not (folder / "scene.json").exists():
                make.make(name, folder)
        ensure_toml(folder)
        if not (folder / "reference.exr").exists():
            print(f"{folder.name}: rendering a reference", flush=True)
            render_ajar(given.ajar, folder, "ajar", given.reference, folder / "reference.exr", seed=1)
        rows = results[folder.name] = []
        for label in ALL:
            if given.only and not any(word in label for word in given.only.split(",")):
                continue
            prefix = given.out / f"{folder.name}-{label.replace(' ', '-').replace(',', '')}"
            for row in run(label, folder, seconds, prefix, given.ajar):
                rows.append(row)
                print(f"{folder.name:12} " + json.dumps(row), flush=True)
        (given.out / "results.json").write_text(json.dumps(results, indent=1))
        (given.out / "results.md").write_text("\n\n".join(table(*item) for item in results.items()) + "\n")
        curves(results, given.out / "curves.svg")
    print((given.out / "results.md").read_text())


if __name__ == "__main__":
    main()

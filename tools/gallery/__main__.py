"""One page of pictures of all assets below a folder, with what each import kept, approximated and dropped.

    cargo build --release
    python tools/gallery FOLDER -o out/gallery

writes `index.html` with the pictures beside it. Every file that Ajar imports becomes a row; where the folder has a
`MANIFEST.md` with a table of `folder`, `open this` and `exercises`, those files alone, with what they are there for.
"""

import argparse
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import assets
import page
import trial


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="gallery", description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("gallery"), help="folder of the page [gallery]")
    parser.add_argument("--only", default="", help="only assets whose name contains this")
    parser.add_argument("--size", type=int, default=256, help="pixels on each side [256]")
    parser.add_argument("--spp", type=int, default=32, help="samples a pixel [32]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="how many at once [one a core]")
    parser.add_argument("--ajar", default=os.environ.get("AJAR_BIN", "target/release/ajar"), help="the program")
    return parser.parse_args()


def main() -> int:
    """Tries every asset; the exit code says whether any that should render did not."""
    args = arguments()
    args.output.mkdir(parents=True, exist_ok=True)
    found = [asset for asset in assets.find(args.folder) if args.only in asset.name]
    how = trial.How(args.ajar, args.output, args.size, args.spp, threads=max((os.cpu_count() or 1) // args.jobs, 1))
    with ThreadPoolExecutor(args.jobs) as pool:
        results = []
        for result in pool.map(lambda asset: trial.run(asset, how), found):
            results.append(result)
            print(f"{len(results)}/{len(found)} {result.line()}", flush=True)
    (args.output / "index.html").write_text(page.page(args.folder, results), "utf-8")
    print(f"wrote {args.output / 'index.html'}")
    return int(any(result.has_crashed for result in results))


sys.exit(main())

"""Arguments in, an Ajar scene out: the protocol of plug-ins (docs/plug-ins.md)."""

from __future__ import annotations

import argparse
import gc
import json
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from .report import Report, StageError

if TYPE_CHECKING:
    from .document import Document

EXTENSIONS = ["usd", "usda", "usdc", "usdz"]
HEADS = [b"#usda", b"PXR-USDC"]
# Bytes that a user's pipe may hold on Linux unless told otherwise.
PIPE = 1 << 20


def arguments() -> argparse.Namespace:
    """The arguments; those of later versions of the protocol are ignored."""
    parser = argparse.ArgumentParser(prog="ajar_import_usd", allow_abbrev=False)
    parser.add_argument("--probe", action="store_true")
    parser.add_argument("--import", dest="file", type=Path)
    parser.add_argument("--allow", action="append", default=[], type=Path)
    parser.add_argument("--memory-limit", default=8 << 30, type=int)
    parser.add_argument("--variant", action="append", default=[])
    parser.add_argument("--frame", type=float)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--fps", type=float)
    return parser.parse_known_args()[0]


def convert(args: argparse.Namespace, report: Report) -> Document:
    """The scene that the file holds."""
    # Packages that are not there are told as an error, and --probe needs none of them.
    from . import layers, mtlx, stage, walk
    from .document import Document

    # As usd-core names layers, links kept: what is looked at before must be what the stage is composed of.
    file = Path(os.path.abspath(args.file))
    jail = layers.Jail(file, args.allow)
    with report.listening():
        found = layers.check(file, jail, args.memory_limit, report)
        # Held until the stage is read.
        held = [*found, *mtlx.resolve(found, report)]
        moment = stage.Moment(args.frame, args.seconds, args.fps)
        opened = stage.open_stage(file, args.variant, moment, report)
        document = Document(args.memory_limit)
        document.variants = stage.variant_sets(opened.stage)
        walk.Walk(opened, document, jail, report).run()
        del held
    return document


def widen(pipe: TextIO) -> None:
    """Lets a pipe hold more, where the system can: writer and reader wait for each other less often."""
    with suppress(ImportError, AttributeError, OSError):
        import fcntl

        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, PIPE)


def main() -> None:
    """The program."""
    args = arguments()
    if args.probe:
        print(json.dumps({"protocol": 1, "extensions": EXTENSIONS, "heads": [head.hex() for head in HEADS]}))
        return
    report = Report()
    # What is in circles goes with the program; to look for it while usd-core is loaded and arrays are made takes time.
    gc.disable()
    # Folders of the environment would be searched for layers that are not beside the scene.
    os.environ.pop("PXR_AR_DEFAULT_SEARCH_PATH", None)
    # Bindings of prims that do not apply the schema act all the same: no warning for each.
    os.environ["USD_SHADE_WARN_ON_MISSING_MATERIAL_BINDING_API"] = "0"
    # Its helpers would wait for more work in a loop, and take a core from who reads what is printed here.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    # That settings are set needs no banner.
    os.environ["TF_ENV_SETTING_ALERTS_ENABLED"] = "0"
    sys.setrecursionlimit(20_000)
    try:
        if args.file is None:
            raise StageError("--probe or --import FILE is needed", cause="usage")
        document = convert(args, report)
    except StageError as failure:
        report.fail(failure)
        sys.exit(1)
    except ImportError as error:
        hint = f"install it there; or remove {sys.prefix}, if Ajar made that, and it is made again"
        message = f"{error}: {sys.executable} lacks a package that USD files need"
        report.fail(StageError(message, hint=hint, cause="system"))
        sys.exit(1)
    except (MemoryError, RecursionError) as error:
        report.fail(StageError(f"the stage is too large: {type(error).__name__}", cause="resource"))
        sys.exit(1)
    widen(sys.stdout)
    document.write(sys.stdout.buffer)
    sys.stdout.buffer.flush()
    # Taking usd-core down in good order would take as long as reading a large stage.
    os._exit(0)

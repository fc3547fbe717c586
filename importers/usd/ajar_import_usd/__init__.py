"""USD for Ajar: composes a stage with usd-core and prints it as an Ajar scene.

A plug-in like any other (docs/plug-ins.md): `python -m ajar_import_usd --probe` and `--import FILE`.
"""

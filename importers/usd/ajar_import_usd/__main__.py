"""`python -m ajar_import_usd`."""

from .main import main

main()

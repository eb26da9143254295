from freebeam_sym.cli import main

raise SystemExit(main())

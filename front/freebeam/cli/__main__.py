from freebeam.cli import main

raise SystemExit(main())

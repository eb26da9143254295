"""Print the lowest versions that pyproject.toml allows, as pip's constraints.

python .ci/lowest.py > build/lowest.txt
"""

import re
import tomllib
from pathlib import Path

given = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
project = given["project"]
required = [*given["build-system"]["requires"], *project["dependencies"]]
required += [line for lines in project["optional-dependencies"].values() for line in lines]
pattern = re.compile(r"(?P<name>[\w.-]+)(?:\[[\w,]+\])?>=(?P<low>[\w.]+)")
found = [match for match in map(pattern.match, required) if match]
print("\n".join(sorted({f"{match['name']}=={match['low']}" for match in found})))

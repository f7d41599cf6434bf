#!/bin/sh
# The springs of a study as files for other programs: sh examples/export.sh [STUDY [FOLDER]]
set -eu
study=${1:-data/studies/uic60-s1002.toml}
folder=${2:-out/export}

railspring calibrate "$study" -o "$folder"
# a table of force and displacement, and a spring for OpenSees, against the rail's section
railspring export "$folder/stiffness.json" --to force-displacement --reference beam -o "$folder/table"
railspring export "$folder/stiffness.json" --to opensees --reference beam -o "$folder/opensees"

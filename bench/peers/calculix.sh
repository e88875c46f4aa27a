#!/bin/sh
# CalculiX on FOLDER/plate.inp of export_plate; one JSON line. One thread. Package calculix-ccx.
# calculix.sh FOLDER
folder=$1
if ! command -v ccx > /dev/null; then
  echo "skipped: calculix: no ccx (package calculix-ccx)"
  exit 77
fi
cd "$folder" || exit 2
OMP_NUM_THREADS=1 CCX_NPROC_EQUATION_SOLVER=1 CCX_NPROC_STIFFNESS=1 OPENBLAS_NUM_THREADS=1 \
  /usr/bin/env time -f '%U %S %M' -o calculix.time ccx plate > calculix.log 2>&1
awk -v kernel="${OPENBLAS_CORETYPE:-as shipped}" '
  FNR == NR { seconds = $1 + $2; memory = int($3 / 1024); next }
  # the columns of the table of eigenvalues: mode, eigenvalue, rad/time, cycles/time
  NF >= 4 && $1 ~ /^[0-9]+$/ && $2 ~ /E/ && !done { hz[$1] = $4; last = $1 }
  /P A R T I C I P A T I O N/ { done = 1 }
  END { printf "{\"peer\": \"calculix\", \"kernel\": \"%s\", \"cpu_s\": %.2f, \"peak_mb\": %d, " \
               "\"first_hz\": %.4f, \"last_hz\": %.4f}\n", kernel, seconds, memory, hz[7], hz[last] }
' calculix.time plate.dat

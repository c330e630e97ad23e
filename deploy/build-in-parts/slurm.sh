#!/bin/sh
# A build in parts by Slurm, on nodes that share the folders:
#
#   slurm.sh town.surf work a.laz b.laz
#
# Options of sbatch come from the environment (SBATCH_PARTITION, SBATCH_ACCOUNT). A step that failed is submitted again
# by running this script again: steps that are done end at once. PARTS may not exceed MaxArraySize - 1 of the cluster.
set -eu

surfcastd=${SURFCASTD:-surfcastd}
parts=${PARTS:-16}
model=$1
work=$2
shift 2

# submit AFTER COMMAND... [SBATCH OPTION]: prints the number of the job that runs COMMAND once AFTER has succeeded.
submit() {
  after=$1
  command=$2
  shift 2
  sbatch --parsable ${after:+--dependency=afterok:$after} "$@" --wrap "$command"
}

quoted=
for scan; do
  quoted="$quoted '$scan'"
done

plan=$(submit '' "$surfcastd build-plan $quoted --work '$work' --parts $parts")
part=$(submit "$plan" "$surfcastd build-part \$SLURM_ARRAY_TASK_ID --work '$work'" --array="1-$parts")
signs=$(submit "$part" "$surfcastd build-signs --work '$work'")
blocks=$(submit "$signs" "$surfcastd build-blocks \$SLURM_ARRAY_TASK_ID --work '$work' &&
rm -f '$work'/part-\$SLURM_ARRAY_TASK_ID" --array="1-$parts")
submit "$blocks" "$surfcastd build-merge --work '$work' --output '$model'"

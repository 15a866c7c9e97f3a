#!/bin/sh
# Runs a study as an array of Slurm jobs: sbatch slurm_array.sh STUDY RESULTS
# The job that ends last merges the shards. The same command submits an interrupted study again.
#SBATCH --job-name=bubbletouch
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --time=2:00:00
#SBATCH --mem=4G
#SBATCH --requeue
set -eu
study=$1 results=$2
n=${SLURM_ARRAY_TASK_COUNT:-8}
bubbletouch run "$study" --out "$results" --shard "$SLURM_ARRAY_TASK_ID/$n" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
touch "$results/shard.$SLURM_ARRAY_TASK_ID-of-$n.done"
# mkdir succeeds in one job only.
done=$(find "$results" -name "shard.*-of-$n.done" | wc -l)
if [ "$done" -eq "$n" ] && mkdir "$results/merging" 2>/dev/null; then
  bubbletouch merge "$study" --out "$results" --quiet
  rm -f "$results"/shard.*-of-"$n".done
  rmdir "$results/merging"
fi

"""Runs a study on Slurm with Dask: python dask_slurm.py STUDY RESULTS [N_JOBS]"""

import sys

import bubbletouch.distributed
from dask_jobqueue import SLURMCluster
from distributed import Client

if __name__ == "__main__":
    study, results, n_jobs = sys.argv[1], sys.argv[2], int([*sys.argv, "8"][3])
    with SLURMCluster(cores=1, memory="4GB", walltime="02:00:00") as cluster, Client(cluster) as client:
        cluster.scale(jobs=n_jobs)
        done = bubbletouch.distributed.run(study, client, n_shards=4 * n_jobs, out=results)
        print(done["summary"].title, done.folder)

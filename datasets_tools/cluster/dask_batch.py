#!/usr/bin/env python3
"""A batch by Dask, a shard a task:
    dask_batch.py [--scheduler HOST:PORT] SHARDS orbifit batch SOURCE --task TASK --out DIR ...
Without a scheduler a cluster of this machine's processors is begun. A worker that dies has its shards done by
another, which goes on where it was. Needs Dask's `distributed` (Debian: python3-distributed) and nothing of Orbifit
but the program."""
import argparse
import subprocess
import sys


def run_shard(index, shards, command):
    """Exit code of one shard; it is raised where the program was killed, so that Dask begins it again."""
    code = subprocess.run([*command, "--shard", f"{index}/{shards}", "--jobs", "1", "--quiet"]).returncode
    if code < 0:
        raise RuntimeError(f"shard {index} was killed by signal {-code}")
    return code


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scheduler", help="address of a running scheduler")
    parser.add_argument("shards", type=int)
    parser.add_argument("command", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    try:
        from distributed import Client
    except ImportError:
        sys.exit("dask_batch.py needs Dask's distributed, which is not installed")
    with Client(arguments.scheduler) if arguments.scheduler else Client(threads_per_worker=1) as client:
        shards = range(1, arguments.shards + 1)
        codes = client.gather(client.map(run_shard, shards, shards=arguments.shards, command=arguments.command,
                                         retries=3, pure=False))
    # The worst of them, as one batch would end: some failed (5) only where nothing worse happened.
    others = [code for code in codes if code not in (0, 5)]
    sys.exit(others[0] if others else max(codes))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Asks which mutants the tests notice.

run_mutants.py LIST PROGRAM...: LIST is what instrument.py wrote, a PROGRAM a test program that was built with it. Each test
is run once by itself, to learn its time and which mutants it reaches; then every mutant is tried with the tests that reach it,
quick ones first, until one fails. Prints the survivors and a table by folder; exits with 1 where a test fails without a mutant.
"""
import collections
import concurrent.futures
import os
import subprocess
import sys
import tempfile
import time

SLOW = 20  # of a test's own time: a mutant that takes longer is killed, as one that does not end
FIRST = 8  # tests of the first round of a mutant; the next takes four times as many


def run(program, tests, longest, **environment):
    """Whether the tests pass, and the seconds that they took."""
    begin = time.monotonic()
    try:
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([program, "--gtest_filter=" + ":".join(tests), "--gtest_fail_fast", "--gtest_brief=1"],
                                  env=os.environ | environment, cwd=folder, timeout=longest, check=False,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        passed = done.returncode == 0
    except subprocess.TimeoutExpired:
        passed = False
    return passed, time.monotonic() - begin


def names(program):
    """The program's tests, as filters name them."""
    suite = ""
    listed = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
    for line in listed.splitlines():
        word = line.split("#")[0].rstrip()
        if word.startswith("  "):
            yield suite + word.strip()
        elif word.endswith("."):
            suite = word


def reach(program, test):
    """(program, test, passed, seconds, mutants reached)."""
    with tempfile.NamedTemporaryFile() as file:
        passed, seconds = run(program, [test], 1200, ORBIFIT_REACHED=file.name)
        with open(file.name, encoding="ascii") as lines:
            return program, test, passed, seconds, {int(line) for line in lines}


def killer(number, tests):
    """The program of the tests that notice the mutant, or None."""
    tests = sorted(tests)  # by seconds
    begin, count = 0, FIRST
    while begin < len(tests):
        by_program = collections.defaultdict(list)
        for seconds, program, test in tests[begin:begin + count]:
            by_program[program].append((test, seconds))
        for program, some in by_program.items():
            longest = 5 + SLOW * sum(seconds for _, seconds in some)
            if not run(program, [test for test, _ in some], longest, ORBIFIT_MUTANT=str(number))[0]:
                return program
        begin, count = begin + count, count * 4
    return None


def main():
    list_file, *programs = sys.argv[1:]
    with open(list_file, encoding="utf-8") as file:
        mutants = [line.rstrip("\n").split("\t") for line in file]
    programs = [os.path.abspath(program) for program in programs]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        alone = list(pool.map(lambda one: reach(*one), [(p, t) for p in programs for t in names(p)]))
        failed = [test for _, test, passed, _, _ in alone if not passed]
        print(f"{len(alone)} tests, {sum(one[3] for one in alone):.0f} s; without a mutant fail: {failed or 'none'}", flush=True)
        if failed:
            sys.exit(1)
        reaching = collections.defaultdict(list)
        for program, test, _, seconds, numbers in alone:
            for number in numbers:
                reaching[number].append((seconds, program, test))

        common = os.path.commonpath([os.path.dirname(mutant[1]) for mutant in mutants])

        def attempt(number):
            found = killer(number, reaching[number])
            if found is None:  # said at once: all of them may take an hour
                _, path, line, column, name, mutant = mutants[number]
                state = "survives" if reaching[number] else "not reached"
                print(f"{state}: {os.path.relpath(path, common)}:{line}:{column}: {name} -> {mutant}", flush=True)
            return found

        outcome = list(pool.map(attempt, range(len(mutants))))

    table = collections.defaultdict(lambda: [0, 0, 0])
    for number, (_, path, *_) in enumerate(mutants):
        row = table[os.path.relpath(os.path.dirname(path), common)]
        row[0] += 1
        row[1] += outcome[number] is not None
        row[2] += not reaching[number]
    print(f"{'folder':40} mutants killed  not reached")
    for folder, (count, killed, unreached) in sorted(table.items()):
        print(f"{folder:40} {count:7} {killed:6} {unreached:12}")
    killed = sum(row[1] for row in table.values())
    print(f"{killed} of {len(mutants)} killed: {100 * killed / max(1, len(mutants)):.1f} %")


if __name__ == "__main__":
    main()

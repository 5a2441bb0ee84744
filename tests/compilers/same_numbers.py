#!/usr/bin/env python3
"""Whether two folders hold the same text files: the same words, and numbers that differ by no more than is allowed.

same_numbers.py FOLDER OTHER ALLOWED: ALLOWED is a fraction of the largest number in the file, which for a mesh is about its
size. Prints a line a file with the largest difference; exits with 1 where something else differs, or more.
"""
import os
import re
import sys

NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def read(path):
    """The text with a # in place of each number, and the numbers."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return NUMBER.sub("#", text), [float(word) for word in NUMBER.findall(text)]


def difference(one, other):
    """The largest between numbers, as a fraction of the largest of them; None where the files are not alike."""
    (words, numbers), (other_words, other_numbers) = read(one), read(other)
    if words != other_words or len(numbers) != len(other_numbers):
        return None
    # Counts and indices are whole numbers, and must be the same.
    if any(a != b and a == int(a) and b == int(b) and abs(a) > 1 for a, b in zip(numbers, other_numbers)):
        return None
    reals = [abs(a) for a in numbers if a != int(a)]
    largest = max(reals, default=1)
    return max((abs(a - b) for a, b in zip(numbers, other_numbers)), default=0) / largest


def main():
    folder, other, allowed = sys.argv[1], sys.argv[2], float(sys.argv[3])
    names = sorted(os.listdir(folder))
    failed = names != sorted(os.listdir(other)) or not names
    if failed:
        print(f"other files: {names} and {sorted(os.listdir(other))}")
    for name in set(names) & set(os.listdir(other)):
        found = difference(os.path.join(folder, name), os.path.join(other, name))
        bad = found is None or found > allowed
        failed = failed or bad
        print(f"{name}: {'not alike' if found is None else f'{found:.1e}'}{', TOO FAR' if bad else ''}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

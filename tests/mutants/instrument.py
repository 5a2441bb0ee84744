#!/usr/bin/env python3
"""Makes mutants of C++ sources: binary operators on numbers and truth values that can be flipped while the program runs.

instrument.py COMPILE_COMMANDS MOST SEED LIST FILE...: of all such operators of the FILEs it takes MOST, drawn with SEED, none
within another, rewrites the files in place and writes LIST: number, file, line, column, operator, its mutant.
"""
import json
import os
import random
import shlex
import sys

from clang.cindex import CursorKind, Index, TypeKind

INTEGERS = {TypeKind.BOOL, TypeKind.CHAR_S, TypeKind.CHAR_U, TypeKind.UCHAR, TypeKind.SCHAR, TypeKind.SHORT, TypeKind.USHORT,
            TypeKind.INT, TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG, TypeKind.ENUM}
REALS = {TypeKind.FLOAT, TypeKind.DOUBLE}
# A bound on a real number that is met exactly is met by chance: such comparisons are turned round, those of integers move by one.
OF_REALS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/", "/": "*"}
OF_INTEGERS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "+",
               "&&": "||", "||": "&&"}


def arguments(command):
    """The options of a line of compile_commands.json that libclang needs."""
    words = shlex.split(command["command"])
    kept = []
    for at, word in enumerate(words):
        if word.startswith(("-I", "-D", "-std")):
            kept.append(word)
        elif word == "-isystem":
            kept += [word, words[at + 1]]
    return kept


def operator_of(cursor, left, right, text):
    """Where the operator stands in the file, and which it is; None where a macro writes it."""
    between = text[left.extent.end.offset:right.extent.start.offset]
    name = between.strip().strip("()").strip()
    if not name or cursor.extent.start.offset >= left.extent.start.offset + 1:
        return None
    return left.extent.end.offset + between.index(name), name


def candidates(path, command):
    """(begin, operator, end, name, mutant) of each operator of the file that may be flipped."""
    unit = Index.create().parse(path, args=arguments(command))
    with open(path, "rb") as file:
        text = file.read()
    decoded = text.decode("latin-1")  # a character a byte, as offsets are
    found = []

    def visit(cursor, constant):
        for child in cursor.get_children():
            if child.location.file is None or child.location.file.name != path:
                continue
            fixed = constant or child.kind in (CursorKind.STATIC_ASSERT, CursorKind.TEMPLATE_TYPE_PARAMETER) or (
                child.kind == CursorKind.VAR_DECL and "constexpr" in [t.spelling for t in child.get_tokens()][:6])
            visit(child, fixed)
            if fixed or child.kind != CursorKind.BINARY_OPERATOR:
                continue
            parts = list(child.get_children())
            if len(parts) != 2:
                continue
            kinds = [part.type.get_canonical().kind for part in parts]
            if not all(kind in INTEGERS or kind in REALS for kind in kinds):
                continue
            place = operator_of(child, parts[0], parts[1], decoded)
            table = OF_REALS if any(kind in REALS for kind in kinds) else OF_INTEGERS
            if place is None or place[1] not in table:
                continue
            found.append((child.extent.start.offset, place[0], child.extent.end.offset, place[1], table[place[1]]))

    visit(unit.cursor, False)
    return decoded, found


def main():
    commands_file, most, seed, list_file, *files = sys.argv[1:]
    with open(commands_file, encoding="utf-8") as file:
        commands = {os.path.realpath(command["file"]): command for command in json.load(file)}
    texts, drawn = {}, []
    for path in sorted(os.path.realpath(name) for name in files):
        text, found = candidates(path, commands[path])
        texts[path] = text
        drawn += [(path, *one) for one in found]
    total = len(drawn)
    random.Random(int(seed)).shuffle(drawn)

    taken = []
    for one in drawn:
        if len(taken) == int(most):
            break
        if all(other[0] != one[0] or other[3] <= one[1] or one[3] <= other[1] for other in taken):
            taken.append(one)
    taken.sort()
    with open(list_file, "w", encoding="utf-8") as file:
        for number, (path, begin, at, _, name, mutant) in enumerate(taken):
            line = texts[path].count("\n", 0, at) + 1
            column = at - texts[path].rfind("\n", 0, at)
            print(number, path, line, column, name, mutant, sep="\t", file=file)
    for number, (path, begin, at, end, name, mutant) in reversed(list(enumerate(taken))):
        text = texts[path]
        left, right = text[begin:at], text[at + len(name):end]
        texts[path] = (f"{text[:begin]}(orbifit_mutants::lives({number}) ? (({left}) {mutant} ({right})) : "
                       f"(({left}) {name} ({right}))){text[end:]}")
    for path in {one[0] for one in taken}:
        header = os.path.join(os.path.dirname(os.path.abspath(__file__)), "mutant.h")
        with open(path, "w", encoding="latin-1") as file:
            file.write(f'#include "{header}"\n{texts[path]}')
    print(f"{len(taken)} of {total} operators in {len(files)} files")


if __name__ == "__main__":
    main()

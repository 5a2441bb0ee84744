#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. Arguments go to ctest: ./tests/run.sh -R point_group
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"

install_packages "${program_packages[@]}" "${test_packages[@]}" "${editor_packages[@]}"
build_release -DORBIFIT_TEST_EDITOR_PAGE=ON -DORBIFIT_BUILD_TESTS=ON -DORBIFIT_BUILD_BASELINES=ON -DORBIFIT_BUILD_PYTHON=ON -DPython_EXECUTABLE=/usr/bin/python3
ctest --test-dir "$build" --output-on-failure -j "$(nproc)" "$@"

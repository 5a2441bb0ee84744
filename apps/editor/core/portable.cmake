# What the WebAssembly build needs in the place of Debian's packages for this machine. Its headers are linked one by one:
# all of /usr/include would hide those of emscripten. Included by the project's CMakeLists.txt.
set(portable ${CMAKE_BINARY_DIR}/portable)
file(MAKE_DIRECTORY ${portable})
foreach(header IN ITEMS nlohmann eigen3/Eigen nanoflann.hpp)
  cmake_path(GET header FILENAME name)
  find_path(folder_of_${name} NAMES ${header} HINTS /usr/include /usr/local/include NO_CMAKE_FIND_ROOT_PATH REQUIRED)
  file(CREATE_LINK ${folder_of_${name}}/${header} ${portable}/${name} SYMBOLIC)
endforeach()
foreach(package IN ITEMS nlohmann_json::nlohmann_json Eigen3::Eigen nanoflann::nanoflann)
  add_library(${package} INTERFACE IMPORTED)
  target_include_directories(${package} SYSTEM INTERFACE ${portable})
endforeach()

set(ORBIFIT_PRECOMPILE OFF)
set(ORBIFIT_UNITY ON)
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
if(EMSCRIPTEN)
  set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
  add_compile_options("SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/library_gaps.h" -msimd128 -fwasm-exceptions
                      "-ffile-prefix-map=${PROJECT_SOURCE_DIR}=." -Wno-unknown-warning-option)

  add_link_options(-fwasm-exceptions -O3)
endif()

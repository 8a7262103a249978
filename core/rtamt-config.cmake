# find_package(rtamt CONFIG): what operators outside this repository, and programs in
# C and C++, are built with.
#
#   rtamt::rtamt                             the C library and its header rtamt.h; not in the Python package
#   rtamt::kernel                            the header rtamt/kernel.hpp
#   rtamt_add_kernels(<name> <source>...)    a shared library of kernels, <name>.so or .dll

include("${CMAKE_CURRENT_LIST_DIR}/rtamt-targets.cmake")

# Optimised unless the build says otherwise; contraction is off so that a kernel gives the same bits
# as its definition on every machine.
function(rtamt_add_kernels name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE rtamt::kernel)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    target_compile_options(${name} PRIVATE $<IF:$<CXX_COMPILER_ID:MSVC>,/O2,-O2>)
  endif()
  if(NOT MSVC)
    target_compile_options(${name} PRIVATE -ffp-contract=off)
  endif()
endfunction()

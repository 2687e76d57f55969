# Build settings and the two functions by which every folder declares itself.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

option(VALSALVA_NATIVE "Optimise for the machine that builds" ON)
option(VALSALVA_SANITIZE "Address and undefined-behaviour sanitizers" OFF)

add_library(valsalva_options INTERFACE)
target_include_directories(valsalva_options INTERFACE ${CMAKE_SOURCE_DIR}/common)
# GCC 12 warns inside its own AVX-512 headers (its bug 105593), hence no (maybe-)uninitialized.
target_compile_options(valsalva_options INTERFACE -Wall -Wextra -Wno-maybe-uninitialized -Wno-uninitialized -fno-math-errno -fno-trapping-math)
if(VALSALVA_NATIVE)
  target_compile_options(valsalva_options INTERFACE -march=native)
endif()
if(VALSALVA_SANITIZE)
  target_compile_options(valsalva_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
  target_link_options(valsalva_options INTERFACE -fsanitize=address,undefined)
endif()

# A folder takes part as soon as it has a CMakeLists.txt.
function(valsalva_add_folder folder)
  if(EXISTS ${CMAKE_SOURCE_DIR}/${folder}/CMakeLists.txt)
    add_subdirectory(${folder})
  endif()
endfunction()

# valsalva_module(NAME dependency...): the static library valsalva::NAME from all sources of the folder.
function(valsalva_module name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(sources)
    add_library(valsalva_${name} STATIC ${sources})
    target_link_libraries(valsalva_${name} PUBLIC valsalva_options ${ARGN})
  else()  # a folder of headers only
    add_library(valsalva_${name} INTERFACE)
    target_link_libraries(valsalva_${name} INTERFACE valsalva_options ${ARGN})
  endif()
  add_library(valsalva::${name} ALIAS valsalva_${name})
endfunction()

# valsalva_executable(NAME SOURCES file... LINK dependency...)
function(valsalva_executable name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE valsalva_options ${arg_LINK})
endfunction()

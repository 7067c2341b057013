# SPDX-License-Identifier: Apache-2.0
# Installs the library below WORK, then builds and runs the consumers against what was installed and
# nothing else. Run by CTest; see CMakeLists.txt for the variables.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})

# As a part of the consumer: nothing is installed, and neither program nor tests are made.
if(WAY STREQUAL subdirectory)
  run(${CMAKE_COMMAND} -S ${SOURCE}/tests/package/consumer -B ${WORK} -G ${GENERATOR}
      -DCMAKE_BUILD_TYPE=Release -DFASTTREE_SOURCE=${SOURCE}
      -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
      -DCMAKE_CXX_COMPILER_LAUNCHER=${CXX_COMPILER_LAUNCHER})
  run(${CMAKE_COMMAND} --build ${WORK})
  run(${WORK}/consumer_cpp)
  run(${WORK}/consumer_c)
  foreach(part apps tests)
    if(EXISTS ${WORK}/fasttree/${part})
      message(FATAL_ERROR "${part} is configured as a part of another project")
    endif()
  endforeach()
  return()
endif()

set(prefix ${WORK}/prefix)

# The static library of the build that is under test, or a shared one built for this purpose.
if(SHARED)
  get_filename_component(shared_build ${WORK} DIRECTORY)
  set(shared_build ${shared_build}/shared_build)
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${shared_build} -G ${GENERATOR}
      -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=ON -DFASTTREE_APPS=OFF -DFASTTREE_TESTS=OFF
      -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
      -DCMAKE_CXX_COMPILER_LAUNCHER=${CXX_COMPILER_LAUNCHER} -DCMAKE_INSTALL_LIBDIR=${LIBDIR})
  run(${CMAKE_COMMAND} --build ${shared_build} --target fasttree)
  set(BUILD ${shared_build})
endif()
run(${CMAKE_COMMAND} --install ${BUILD} --component library --prefix ${prefix})

# A copy of the consumer, so that nothing of the project's tree is near it; and the prefix moved
# after installing, so that nothing remembers where it was.
file(RENAME ${prefix} ${WORK}/moved)
set(prefix ${WORK}/moved)
file(COPY ${SOURCE}/tests/package/consumer DESTINATION ${WORK})

if(WAY STREQUAL cmake)
  run(${CMAKE_COMMAND} -S ${WORK}/consumer -B ${WORK}/consumer_build -G ${GENERATOR}
      -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${prefix}
      -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER})
  run(${CMAKE_COMMAND} --build ${WORK}/consumer_build)
  run(${WORK}/consumer_build/consumer_cpp)
  run(${WORK}/consumer_build/consumer_c)
else()
  set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
  set(ENV{LD_LIBRARY_PATH} ${prefix}/${LIBDIR})
  foreach(what cflags libs)
    execute_process(COMMAND ${PKG_CONFIG} --${what} fasttree OUTPUT_VARIABLE ${what}
                    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(${what} UNIX_COMMAND "${${what}}")
  endforeach()
  run(${CXX_COMPILER} -std=c++20 ${cflags} ${WORK}/consumer/consumer.cpp -o ${WORK}/consumer_cpp
      ${libs})
  run(${C_COMPILER} -std=c99 ${cflags} ${WORK}/consumer/consumer.c -o ${WORK}/consumer_c ${libs})
  run(${WORK}/consumer_cpp)
  run(${WORK}/consumer_c)
endif()

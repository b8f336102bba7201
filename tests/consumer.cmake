# Installs a part of Lambent into an empty folder and builds a program against what is there. Run by CTest as
#     cmake -D COMPONENT=sampler|volume|bake -D BUILD_DIR=... -D WORK_DIR=... -D C_COMPILER=... -D CXX_COMPILER=...
#           -D CONFIG=... -D SANITIZE=... [-D SHARED_FROM=source folder -D NM=...] -P consumer.cmake
# SHARED_FROM: not what BUILD_DIR has, but the sampler built as a shared library from there.
cmake_minimum_required(VERSION 3.25)

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "${command}\nfailed (${status}):\n${output}")
    endif()
    message("${output}")
endfunction()

set(prefix "${WORK_DIR}/prefix with space")
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})

set(what)
set(without)
set(languages -D CMAKE_C_COMPILER=${C_COMPILER})
if(COMPONENT STREQUAL "sampler")
    set(what --component sampler)
    # Neither C++ nor any library may be asked for: asking fails.
    set(ENV{CXX} /nonexistent)
    foreach(package TBB Imath OpenVDB embree TinyGLTF OpenEXR cJSON Threads)
        list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
    endforeach()
else()
    list(APPEND languages -D CMAKE_CXX_COMPILER=${CXX_COMPILER})
endif()

if(SHARED_FROM)
    set(BUILD_DIR ${WORK_DIR}/library)
    run(${CMAKE_COMMAND} -S ${SHARED_FROM} -B ${BUILD_DIR} ${languages} ${without} -D CMAKE_BUILD_TYPE=${CONFIG}
        -D BUILD_SHARED_LIBS=ON -D LMB_SAMPLER_ONLY=ON -D LMB_TESTS=OFF -D LMB_SANITIZE=${SANITIZE})
    run(${CMAKE_COMMAND} --build ${BUILD_DIR} --config "${CONFIG}")
endif()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --config "${CONFIG}" ${what} --prefix ${prefix})
if(COMPONENT STREQUAL "sampler")
    file(GLOB_RECURSE installed RELATIVE ${prefix} "${prefix}/*")
    foreach(file IN LISTS installed)
        if(NOT file MATCHES "/shader/" AND file MATCHES "volume-|bake|openvdb|lambent_volume|grid\\.h|bin/")
            message(FATAL_ERROR "component sampler installs ${file}")
        endif()
    endforeach()
endif()
if(SHARED_FROM)
    file(GLOB_RECURSE shared "${prefix}/*.so")
    if(NOT shared)
        message(FATAL_ERROR "no shared library is installed: ${installed}")
    endif()
    if(NOT SANITIZE)
        run(${CMAKE_COMMAND} -D NM=${NM} -D LIBRARY=${shared} -P ${CMAKE_CURRENT_LIST_DIR}/symbols.cmake)
    endif()
endif()

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK_DIR}/build ${languages} ${without}
    -D CMAKE_BUILD_TYPE=${CONFIG} -D "CMAKE_PREFIX_PATH=${prefix}" -D LAMBENT_COMPONENT=${COMPONENT})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build --config "${CONFIG}")
run(${CMAKE_COMMAND} -E chdir ${WORK_DIR} ${WORK_DIR}/build/consumer)

find_program(PKG_CONFIG pkg-config)
if(COMPONENT STREQUAL "sampler" AND PKG_CONFIG)
    # pkg-config gives words for a shell, which spaces in the prefix would split.
    file(RENAME "${prefix}" ${WORK_DIR}/moved)
    file(GLOB_RECURSE pc ${WORK_DIR}/moved/lambent_sampler.pc)
    get_filename_component(pc_dir ${pc} DIRECTORY)
    set(ENV{PKG_CONFIG_LIBDIR} ${pc_dir})
    execute_process(COMMAND ${PKG_CONFIG} --cflags --libs lambent_sampler OUTPUT_VARIABLE flags
        OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(flags UNIX_COMMAND "${flags}")
    if(SANITIZE)
        list(APPEND flags -fsanitize=${SANITIZE})
    endif()
    run(${C_COMPILER} -std=c11 ${CMAKE_CURRENT_LIST_DIR}/consumer/sampler.c ${flags} -o ${WORK_DIR}/pc_consumer)
    get_filename_component(library_dir ${pc_dir} DIRECTORY)
    set(ENV{LD_LIBRARY_PATH} ${library_dir}) # where a shared library lies
    run(${WORK_DIR}/pc_consumer)
endif()

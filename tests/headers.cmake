# Every public header stands alone: for each one, a C11 and (where the build has C++) a C++17 file that includes only
# it, compiled in the normal build against the include folders that its users have. A header that leans on another one
# being included first breaks the build.

get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)

function(lmb_check_headers layer)
    file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/${layer}/include
        ${PROJECT_SOURCE_DIR}/${layer}/include/lambent/*.h)
    set(sources)
    foreach(header IN LISTS headers)
        get_filename_component(stem ${header} NAME_WE)
        set(source ${CMAKE_CURRENT_BINARY_DIR}/headers/${layer}_${stem})
        # An empty translation unit is not C: hence the declaration.
        set(content "#include <${header}>\nextern int lmb_header_${stem}_stands_alone;\n")
        file(CONFIGURE OUTPUT ${source}.c CONTENT "${content}" @ONLY)
        list(APPEND sources ${source}.c)
        if(CXX IN_LIST languages)
            file(CONFIGURE OUTPUT ${source}.cc CONTENT "${content}" @ONLY)
            list(APPEND sources ${source}.cc)
        endif()
    endforeach()
    if(NOT sources)
        return()
    endif()
    set(target headers_${layer})
    add_library(${target} OBJECT ${sources})
    set_target_properties(${target} PROPERTIES
        C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
        CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
    if(NOT MSVC)
        target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Werror)
    endif()
    # The folders only, not the libraries: a layer sees itself and the layers below it.
    foreach(below IN LISTS ARGN ITEMS ${layer})
        target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/${below}/include)
    endforeach()
endfunction()

lmb_check_headers(sampler)
if(NOT LMB_SAMPLER_ONLY)
    lmb_check_headers(volume sampler)
    lmb_check_headers(bake volume sampler)
endif()

# Tests that other projects can embed Carom: installed, by add_subdirectory, and as README.md shows it.
set(embed ${CAROM_TEST_PREFIX}embed)
set(embed_folder ${CMAKE_CURRENT_LIST_DIR})
set(embed_work ${CMAKE_BINARY_DIR}/embed)

function(carom_add_embed_test name)  # further arguments: options for CMake
    add_test(NAME ${embed}.${name}
        COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${embed_folder} ${embed_work}/${name}
                --build-generator Ninja --build-options -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} ${ARGN}
                --test-command embed)
endfunction()

add_test(NAME ${embed}.install
    COMMAND sh -c "rm -rf '${embed_work}/prefix' && '${CMAKE_COMMAND}' --install '${CMAKE_BINARY_DIR}' \
                   --prefix '${embed_work}/prefix'")
set_tests_properties(${embed}.install PROPERTIES FIXTURES_SETUP installed)
carom_add_embed_test(installed -DCMAKE_PREFIX_PATH=${embed_work}/prefix -DCMAKE_BUILD_TYPE=Release)
set_tests_properties(${embed}.installed PROPERTIES FIXTURES_REQUIRED installed)

# What is embedded is a copy of the sources with the effect in it that docs/add-an-effect.md adds, so that one build
# shows both. Also shows that the library builds without OpenMP, and with scalar kernels alone. It builds by clang, where
# there is one, in half of gcc's time, and without debug information in four fifths (docs/decisions/0015-cold-test-run.md).
find_program(CAROM_CLANG clang++)
if(NOT CAROM_CLANG)
    set(CAROM_CLANG ${CMAKE_CXX_COMPILER})
endif()
add_test(NAME ${embed}.apply_example
    COMMAND ${CAROM_PYTHON} ${embed_folder}/apply_example.py ${PROJECT_SOURCE_DIR} ${embed_work}/effect)
set_tests_properties(${embed}.apply_example PROPERTIES FIXTURES_SETUP effect_sources COST 70)
carom_add_embed_test(subdirectory -DCMAKE_CXX_COMPILER=${CAROM_CLANG} -DCAROM_FOLDER=${embed_work}/effect -DEMBED_EFFECT=ON
                     -DCAROM_OPENMP=OFF -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCAROM_ISAS=scalar -DCAROM_PRECOMPILE_ENGINE=ON -DCAROM_UNITY_ENGINE=ON)
set_tests_properties(${embed}.subdirectory PROPERTIES COST 60 FIXTURES_REQUIRED effect_sources FIXTURES_SETUP effect)
add_test(NAME ${embed}.effect COMMAND ${embed_work}/subdirectory/effect)
set_tests_properties(${embed}.effect PROPERTIES FIXTURES_REQUIRED "effect_sources;effect" COST 40)

add_test(NAME ${embed}.extract_example
    COMMAND ${CAROM_PYTHON} ${embed_folder}/extract_example.py
            ${PROJECT_SOURCE_DIR}/README.md ${embed_work}/readme_example.cpp)
set_tests_properties(${embed}.extract_example PROPERTIES FIXTURES_SETUP readme_example)
carom_add_embed_test(readme_example -DCMAKE_PREFIX_PATH=${embed_work}/prefix -DCMAKE_BUILD_TYPE=Release
                                    -DEMBED_SOURCE=${embed_work}/readme_example.cpp)
set_tests_properties(${embed}.readme_example PROPERTIES FIXTURES_REQUIRED "installed;readme_example")

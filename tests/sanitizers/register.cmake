# Tests under the thread sanitizer: what runs on several threads, and a race that it must find.
# Works with clang and libomp only: libomp loads its tool archer by itself, which tells the sanitizer about OpenMP's
# barriers; gcc's libgomp has nothing like it, and every parallel loop looks like a race.
set(tsan_tests "")
foreach(folder ${CAROM_TEST_FOLDERS})
    string(REPLACE "/" "." name ${folder})
    list(APPEND tsan_tests ${CAROM_TEST_PREFIX}${name})
endforeach()

add_executable(carom_race ${CMAKE_CURRENT_LIST_DIR}/race.cpp)
carom_set_flags(carom_race)
target_link_libraries(carom_race PRIVATE carom_private)
foreach(kind clean racy)
    add_test(NAME ${CAROM_TEST_PREFIX}sanitizer.${kind} COMMAND carom_race ${kind})
    list(APPEND tsan_tests ${CAROM_TEST_PREFIX}sanitizer.${kind})
endforeach()
set_tests_properties(${CAROM_TEST_PREFIX}sanitizer.racy PROPERTIES PASS_REGULAR_EXPRESSION "data race")
set_tests_properties(${tsan_tests} PROPERTIES ENVIRONMENT OMP_NUM_THREADS=4)

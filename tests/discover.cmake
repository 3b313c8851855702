# Run by ctest before it looks at its tests: adds an entry for each suite of the GoogleTest
# programs, those for several ranks at 1 and 2, in the long form at 3 as well (some at one more),
# and for each group of cases of the Python tests. A suite is one process: to start one takes
# longer than most cases. What is set here comes from CMakeLists.txt: source, serial_tests and
# mpi_tests (folder and program, by a blank), mpiexec, environment, floe, hangs [s].

# Long forms take long.
set(most_ranks 2)
if("$ENV{FLOE_FULL}")
  set(hangs 36000)
  set(most_ranks 3)
endif()

# suites_of(TEST): sets folder and program, and suites to those of the program; where it is not
# built adds an entry that fails.
macro(suites_of test)
  string(REGEX MATCH "^([^ ]+) (.+)$" _ "${test}")
  set(folder ${CMAKE_MATCH_1})
  set(program ${CMAKE_MATCH_2})
  set(suites)
  if(EXISTS ${program})
    execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed
                    COMMAND_ERROR_IS_FATAL ANY TIMEOUT 600)
    string(REGEX REPLACE " +#[^\n]*" "" listed "${listed}")
    string(REGEX MATCHALL "[^ \n]+\\.\n" suites "${listed}")
    list(TRANSFORM suites REPLACE "\\.\n$" "")
  else()
    add_test(${folder}_NOT_BUILT ${program})
  endif()
endmacro()

foreach(test IN LISTS serial_tests)
  suites_of("${test}")
  foreach(suite IN LISTS suites)
    add_test(${folder}.${suite} ${program} --gtest_filter=${suite}.*)
    set_tests_properties(${folder}.${suite} PROPERTIES TIMEOUT ${hangs})
  endforeach()
endforeach()

foreach(test IN LISTS mpi_tests)
  suites_of("${test}")
  foreach(suite IN LISTS suites)
    set(most ${most_ranks})
    if(suite MATCHES "^OnOneRank")
      math(EXPR most "${most} + 1")
    endif()
    foreach(ranks RANGE 1 ${most})
      set(name ${folder}.np${ranks}.${suite})
      add_test(${name} ${mpiexec} -n ${ranks} ${program} --gtest_filter=${suite}.*)
      set_tests_properties(${name} PROPERTIES PROCESSORS ${ranks} TIMEOUT ${hangs}
                           ENVIRONMENT "${environment}")
    endforeach()
  endforeach()
endforeach()

# Debian's Python: h5py and numpy are its packages, whatever other Python stands first on the PATH.
execute_process(COMMAND /usr/bin/python3 ${source}/list_cases.py OUTPUT_VARIABLE listed
                COMMAND_ERROR_IS_FATAL ANY
                TIMEOUT 600 OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE "\n" ";" listed "${listed}")
foreach(line IN LISTS listed)
  string(REGEX MATCH "^([^ ]+) ?([^ ]*) ?(.*)$" _ "${line}")  # folder/module, group, cases
  set(script ${source}/${CMAKE_MATCH_1}.py)
  set(group ${CMAKE_MATCH_2})
  string(REPLACE " " ";" cases "${CMAKE_MATCH_3}")
  list(LENGTH cases count)
  get_filename_component(name ${script} NAME_WE)
  set(processors 1)
  # At every step each of two ranks waits for the other, and both for a core if another test has it:
  # so they get both cores, which tools/check counts twice.
  if(name MATCHES "_ranks$")
    set(processors 4)
  endif()
  if(group)
    string(APPEND name .${group})
  endif()
  add_test(${name} /usr/bin/python3 ${script} ${cases})
  set_tests_properties(${name} PROPERTIES PROCESSORS ${processors} TIMEOUT ${hangs}
                       ENVIRONMENT "${environment};FLOE=${floe}"
                       SKIP_REGULAR_EXPRESSION "OK \\(skipped=${count}\\)")
endforeach()

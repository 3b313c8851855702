# Run by ctest before it looks at its tests: adds an entry for each case of the GoogleTest programs
# for several ranks, at 1 and 2 ranks, in the long form at 3 as well (some at one more), and for
# each group of cases of the Python tests. What is set here comes from CMakeLists.txt: source,
# mpi_tests (folder and program, by a blank), mpiexec, environment, floe, hangs [s].

# Long forms take long. (CMake's own function, which comes first, leaves the names of its tests in
# PROGRAM_TESTS.)
set(most_ranks 2)
if("$ENV{FLOE_FULL}")
  set(hangs 36000)
  set(most_ranks 3)
  foreach(test IN LISTS unit_tests_TESTS verification_tests_TESTS)
    set_tests_properties(${test} PROPERTIES TIMEOUT ${hangs})
  endforeach()
endif()

foreach(test IN LISTS mpi_tests)
  string(REGEX MATCH "^([^ ]+) (.+)$" _ "${test}")
  set(folder ${CMAKE_MATCH_1})
  set(program ${CMAKE_MATCH_2})
  if(NOT EXISTS ${program})
    foreach(ranks RANGE 1 ${most_ranks})
      add_test(${folder}.np${ranks}_NOT_BUILT ${program})
    endforeach()
    continue()
  endif()
  execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed
                  COMMAND_ERROR_IS_FATAL ANY TIMEOUT 600)
  string(REGEX REPLACE " +#[^\n]*" "" listed "${listed}")
  string(REPLACE "\n" ";" listed "${listed}")
  foreach(line IN LISTS listed)
    if(line MATCHES "^  (.+)$")
      set(case ${CMAKE_MATCH_1})
      set(most ${most_ranks})
      if(suite MATCHES "^OnOneRank")
        math(EXPR most "${most} + 1")
      endif()
      foreach(ranks RANGE 1 ${most})
        set(name ${folder}.np${ranks}.${suite}${case})
        add_test(${name} ${mpiexec} -n ${ranks} ${program} --gtest_filter=${suite}${case})
        set_tests_properties(${name} PROPERTIES PROCESSORS ${ranks} TIMEOUT ${hangs}
                             ENVIRONMENT "${environment}"
                             SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
      endforeach()
    elseif(line MATCHES "\\.$")
      set(suite ${line})
    endif()
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

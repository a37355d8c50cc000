# cmake -DPROGRAM=TESTS -P long_tests.cmake LIST: fails if a name in LIST (long_tests.txt) matches no test of the program.
math(EXPR last "${CMAKE_ARGC} - 1")
file(STRINGS ${CMAKE_ARGV${last}} names REGEX "^[^#]")
foreach(name IN LISTS names)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests --gtest_filter=${name} OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
  if(NOT found MATCHES "\n  ")
    message(SEND_ERROR "${name} is not a test")
  endif()
endforeach()

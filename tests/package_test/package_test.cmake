# cmake -DROOT=<repository> -DBUILD=<build folder> -DWORK=<empty folder> -DGENERATOR=<of CMake> -P package_test.cmake: installs the
# package, builds the example of capture/ with it, and checks that its picture test passes, and fails for a shift by one pixel.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)

# expect(STATUS PATTERN COMMAND...): runs a command without the settings of the suite.
function(expect status pattern)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=CI --unset=UPDATE_GOLDENS --unset=COLLIDOSCOPE_ASSETS
    PICTURE_RESULTS=${WORK}/results ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL status OR NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "${ARGN}\nstatus ${result}, expected ${status} and a text that matches ${pattern}:\n${output}")
  endif()
endfunction()

expect(0 "" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
expect(0 "state hash" ${prefix}/bin/collidoscope-headless run box_collider --bodies 20 --steps 1 --executor cpu)
expect(0 "TH COLLIDOSCOPE" ${CMAKE_COMMAND} -E cat ${prefix}/share/man/man1/collidoscope-headless.1)
expect(0 "" bash -n ${prefix}/share/bash-completion/completions/collidoscope)

file(COPY ${prefix}/share/collidoscope/example ${prefix}/share/collidoscope/examples DESTINATION ${WORK})
expect(0 "" cc -shared -fPIC -I ${prefix}/include -o ${WORK}/libmine.so ${WORK}/examples/sweep_and_prune.c)
expect(0 "broad phase sweep_and_prune" ${prefix}/bin/collidoscope-headless validate ${WORK}/libmine.so)

expect(0 "" ${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK}/example -B ${WORK}/build -DCMAKE_PREFIX_PATH=${prefix})
expect(0 "" ${CMAKE_COMMAND} --build ${WORK}/build)
set(test ${WORK}/build/triangle_test)
expect(1 "triangle.png is missing" ${test})
expect(1 "refused, because CI is set" CI=true UPDATE_GOLDENS=1 ${test})
expect(0 "wrote " UPDATE_GOLDENS=1 ${test})
expect(0 "PASSED" ${test})
expect(1 "differ by more than 5 of 255, at most 0.1 % may.*in the " TRIANGLE_SHIFT=1 ${test})
file(READ ${WORK}/results/index.html page)
foreach(text "<h2>triangle</h2>" "UPDATE_GOLDENS=1 ctest -R '^Triangle" "class=\"expected\"" "class=\"actual\"" "class=\"difference\"")
  string(FIND "${page}" "${text}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "${WORK}/results/index.html lacks ${text}")
  endif()
endforeach()

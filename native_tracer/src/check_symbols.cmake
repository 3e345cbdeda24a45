# Whether kernels for newer processors offer functions to others.
#
#     cmake -DNM=nm -DNAMESPACE=avx2 -DOBJECTS=kernel.o -DERROR=ON -P check_symbols.cmake
#
# Of functions with the same name, such as the instances of a template, the linker keeps one, for the whole program. One
# that is compiled for newer instructions, and has not their namespace in its name, may be kept for older processors too.

string(LENGTH "${NAMESPACE}" length)
foreach(object ${OBJECTS})
  execute_process(COMMAND ${NM} --defined-only ${object} OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]* W [^\n]*" functions "${lines}")
  list(FILTER functions EXCLUDE REGEX "${length}${NAMESPACE}")
  if(functions)
    list(TRANSFORM functions REPLACE ".* W " "")
    list(JOIN functions "\n  " names)
    set(message "functions of ${NAMESPACE} that others may be linked to:\n  ${names}\nin ${object}")
    if(ERROR)
      message(FATAL_ERROR "${message}")
    endif()
    message(WARNING "${message}")
  endif()
endforeach()

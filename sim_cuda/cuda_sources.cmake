# Compiles the files that launch kernels with nvcc. Without CUDA they are compiled as C++. Changes ${sources}.
file(GLOB_RECURSE cuda_sources CONFIGURE_DEPENDS broad_phase/*.cpp solver/*.cpp)
list(FILTER cuda_sources EXCLUDE REGEX  # these launch no kernel
  "/broad_phase/(broad_phase|bullet_dbvt|bvh_cache|key_bits|pair_check)[.]cpp$|/solver/(contact_cache|contact_solver|plane_contacts|residuals|soft_step_data)[.]cpp$")
foreach(file core/radix_sort core/sort core/scan dynamics/continuous_collision dynamics/move guard/stage_validator measure/inspect
    measure/measure narrow_phase/contact_list publish/pack run/pipeline)
  list(APPEND cuda_sources ${CMAKE_CURRENT_SOURCE_DIR}/${file}.cpp)
endforeach()
set_source_files_properties(${cuda_sources} PROPERTIES LANGUAGE CUDA)

# nvcc needs 9 to 14 s for the headers of each file, so files are compiled in batches, like the unity build for C++. CMake supports
# unity builds for CUDA only from version 3.31.
if(COLLIDOSCOPE_UNITY)
  list(REMOVE_ITEM sources ${cuda_sources})
  set(alone ${CMAKE_CURRENT_SOURCE_DIR}/solver/soft_step.cpp ${CMAKE_CURRENT_SOURCE_DIR}/solver/impact_stage.cpp)
  list(REMOVE_ITEM cuda_sources ${alone})
  list(APPEND sources ${alone})
  set(number 0)
  while(cuda_sources)
    list(SUBLIST cuda_sources 0 4 batch)
    list(REMOVE_ITEM cuda_sources ${batch})
    list(TRANSFORM batch PREPEND "#include \"")
    list(TRANSFORM batch APPEND "\"")
    list(JOIN batch "\n" text)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/cuda_batches/batch_${number}.cu)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}\n" @ONLY)
    list(APPEND sources ${file})
    math(EXPR number "${number} + 1")
  endwhile()
endif()

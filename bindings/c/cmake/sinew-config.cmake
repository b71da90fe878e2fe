# find_package(sinew) gives sinew::sinew, the shared object, and sinew::static.
get_filename_component(_sinew_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET sinew::sinew)
  find_package(Threads REQUIRED)
  add_library(sinew::sinew SHARED IMPORTED)
  set_target_properties(sinew::sinew PROPERTIES
    IMPORTED_LOCATION "${_sinew_prefix}/lib/${CMAKE_SHARED_LIBRARY_PREFIX}sinew${CMAKE_SHARED_LIBRARY_SUFFIX}"
    INTERFACE_INCLUDE_DIRECTORIES "${_sinew_prefix}/include")
  add_library(sinew::static STATIC IMPORTED)
  set_target_properties(sinew::static PROPERTIES
    IMPORTED_LOCATION "${_sinew_prefix}/lib/libsinew.a"
    INTERFACE_INCLUDE_DIRECTORIES "${_sinew_prefix}/include"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;m;${CMAKE_DL_LIBS}")
endif()
unset(_sinew_prefix)

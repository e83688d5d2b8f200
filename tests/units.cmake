# Module by module, properties, the command line.
rneagen_add_test(test_spatial)
rneagen_add_test(test_inertia)
foreach(name test_spatial test_inertia)
	target_link_libraries(${name} PRIVATE m)
endforeach()

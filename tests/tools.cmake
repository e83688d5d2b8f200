# What stands around the generator: the graph, the manual page, the completions.
rneagen_add_test(test_dot read.c)
target_link_libraries(test_dot PRIVATE EXPAT::EXPAT)
find_program(GRAPHVIZ_DOT dot)
add_test(NAME test_dot_graphviz COMMAND test_dot "${GRAPHVIZ_DOT}")
set_tests_properties(test_dot_graphviz PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300)

# SPDX-License-Identifier: Apache-2.0
target_sources(fasttree PRIVATE ${CMAKE_CURRENT_LIST_DIR}/quality.cpp)
fasttree_test(NAME fasttree_quality_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/quality_test.cpp)

/* SPDX-License-Identifier: Apache-2.0 */
/* A board with the accelerator, and a scene's tree made by it: the example of
 * docs/accelerator/integration.md. */
#ifndef FASTTREE_ACCEL_EXAMPLE_H
#define FASTTREE_ACCEL_EXAMPLE_H

#include <stddef.h>

#include "fasttree_accel.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ft_board {
  ft_accel device;
  uint32_t memory; /* what the accelerator may use: from here, a multiple of 4096 */
  uint32_t memory_bytes;
  void* context; /* handed to the three functions */
  /* Copies to the accelerator's memory, past the processor's caches or cleaning them. */
  void (*to_memory)(void* context, uint32_t address, const void* from, size_t bytes);
  /* Copies from there, nothing of it out of the caches. */
  void (*from_memory)(void* context, uint32_t address, void* to, size_t bytes);
  void (*wait)(void* context); /* for the interrupt, or for a while */
} ft_board;

/* A scene of `triangles` triangles, nine floats each, at a depth of at most `depth`: as deep as the
 * memory and six references a triangle allow. 0, or an error of ft_accel_error(); -1 where there is
 * no accelerator or no depth at which the scene fits. Afterwards `order` says where the tree is and
 * `result` how large. */
int ft_board_build(const ft_board* board, const float* corners, uint32_t triangles, uint32_t depth,
                   ft_accel_order* order, ft_accel_result* result);

#ifdef __cplusplus
}
#endif
#endif

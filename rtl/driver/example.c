/* SPDX-License-Identifier: Apache-2.0 */
#include "example.h"

int ft_board_build(const ft_board* board, const float* corners, uint32_t triangles, uint32_t depth,
                   ft_accel_order* order, ft_accel_result* result) {
  const ft_accel* const device = &board->device;
  if (ft_accel_probe(device) != 0) return -1;
  device->write(device->context, FT_ACCEL_IRQ_ENABLE, 1);
  for (;; --depth) {
    const uint64_t bytes = ft_accel_plan(order, board->memory, triangles, 6 * triangles, depth);
    if (bytes != 0 && bytes <= board->memory_bytes) {
      uint32_t error;
      board->to_memory(board->context, order->scene, corners, (size_t)36 * triangles);
      ft_accel_start(device, order);
      while (ft_accel_busy(device)) board->wait(board->context);
      device->write(device->context, FT_ACCEL_IRQ_STATUS, 1);
      error = ft_accel_error(device);
      ft_accel_read_result(device, result);
      if (error != FT_ACCEL_REFERENCES) return (int)error;
    }
    if (depth == 0) return -1;
  }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Driver of the accelerator in rtl/: plans its memory, orders a build, waits, reads what came out.
 * C99, no operating system, no allocation: the caller gives two functions that read and write a
 * 32-bit register, and sees to it that memory is coherent (the accelerator's AXI master does not
 * snoop). The map of registers is in docs/accelerator/integration.md. */
#ifndef FASTTREE_ACCEL_H
#define FASTTREE_ACCEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FT_ACCEL_ID = 0x000, /* reads as FT_ACCEL_ID_VALUE */
  FT_ACCEL_VERSION = 0x004,
  FT_ACCEL_CAPABILITIES = 0x008, /* [7:0] bus bytes, [15:8] MCGUs, [23:16] PSUs, [31:24] section */
  FT_ACCEL_CONTROL = 0x010,      /* write: bits below */
  FT_ACCEL_STATUS = 0x014,       /* [0] busy, [1] done, [2] failed, [7:4] stage, [15:8] error */
  FT_ACCEL_IRQ_ENABLE = 0x018,   /* [0] an interrupt when a build ends */
  FT_ACCEL_IRQ_STATUS = 0x01c,   /* [0] a build has ended; write 1 to clear */
  FT_ACCEL_ORDER = 0x020,        /* ft_accel_order, a word each */
  FT_ACCEL_RESULT = 0x080        /* ft_accel_result, a word each */
};
#define FT_ACCEL_ID_VALUE 0x46545245u

enum { FT_ACCEL_START = 1, FT_ACCEL_CANCEL = 2, FT_ACCEL_FLUSH = 4 };

/* ft_accel_error(): why a build has failed. */
enum {
  FT_ACCEL_OK = 0,
  FT_ACCEL_BAD_ORDER = 1,       /* error_detail: number of the order's word that cannot be */
  FT_ACCEL_SCENE_TOO_LARGE = 2, /* for its buffer */
  FT_ACCEL_NOT_FINITE = 3,      /* error_detail: number of the coordinate, nine a triangle */
  FT_ACCEL_REFERENCES = 4,      /* more than there is room for */
  FT_ACCEL_LEAVES = 5,          /* more than there is room for */
  FT_ACCEL_MEMORY = 6, /* memory answered with an error; error_detail: [4] write, [3:0] ID */
  FT_ACCEL_WINDOW = 7, /* a request outside the window; error_detail: its address */
  FT_ACCEL_CANCELLED = 8,
  FT_ACCEL_TIMEOUT = 9 /* nothing moved for the watchdog's cycles */
};

/* The words from FT_ACCEL_ORDER on. Addresses are of bytes, multiples of 4096. */
typedef struct ft_accel_order {
  uint32_t triangles;
  uint32_t shape;       /* depth; plus FT_ACCEL_LONGEST: the longest axis first, else cyclic */
  uint32_t scene_bytes; /* of the buffer at `scene`: 36 a triangle at least */
  uint32_t scene;       /* nine binary32 a triangle: x, y, z of each corner */
  uint32_t pairs0, pairs1;
  uint32_t sorted_codes;
  uint32_t sorted_ids; /* of the tree: triangle ids by leaf */
  uint32_t leaf_codes;
  uint32_t leaf_rows; /* of the tree: first, count */
  uint32_t marks;
  uint32_t nodes; /* of the tree: lower, upper, split plane, axis; by rank */
  uint32_t reference_capacity;
  uint32_t leaf_capacity;
  uint32_t mark_bytes;
  uint32_t rounds;       /* of the sort, 4 bits each: 8, or as few as hold the depth */
  uint32_t window_begin; /* nothing outside [begin, end) is read or written */
  uint32_t window_end;   /* 0: the end of the 32-bit addresses */
  uint32_t watchdog;     /* cycles without progress before a build gives up; 0: never */
} ft_accel_order;
#define FT_ACCEL_LONGEST 0x100u

/* The words from FT_ACCEL_RESULT on; stable once the build is done. */
typedef struct ft_accel_result {
  uint32_t references;
  uint32_t leaves;             /* rows of the leaf table; an empty scene has 0, and one empty row */
  uint32_t root;               /* bit 31: leaf; else the rank of an internal node */
  uint32_t grid;               /* [4:0] depth, [11:8] [15:12] [19:16] bits of x, y, z */
  uint32_t lower[3], upper[3]; /* the scene's bounds, binary32 */
  uint32_t error_detail;
  uint32_t cycles_low, cycles_high;
  uint32_t stage_cycles[6]; /* scene_bound, morton_code, radix_sort, leaf_node, internal_node,
                               path_compression */
  uint32_t read_beats, write_beats;
  uint32_t climb_steps;
  uint32_t mark_reads, mark_read_hits, mark_writes, mark_write_hits, mark_write_backs;
} ft_accel_result;

typedef struct ft_accel {
  void* context; /* handed to both functions */
  uint32_t (*read)(void* context, uint32_t reg);
  void (*write)(void* context, uint32_t reg, uint32_t value);
} ft_accel;

/* 0 where this is the accelerator, in the version that this file knows. */
static inline int ft_accel_probe(const ft_accel* device) {
  return device->read(device->context, FT_ACCEL_ID) == FT_ACCEL_ID_VALUE &&
                 device->read(device->context, FT_ACCEL_VERSION) == 1
             ? 0
             : -1;
}

/* Lays a build for at most `triangles` triangles, `references` references and depth `depth` out
 * from `base` (a multiple of 4096) on, and fills in the order. Returns the bytes it takes, or 0
 * where they end behind 2^32 or what is asked cannot be. How many references a scene has is for the
 * host to know or to bound: six a triangle is what the depth rule allows. */
static inline uint64_t ft_accel_plan(ft_accel_order* order, uint32_t base, uint32_t triangles,
                                     uint32_t references, uint32_t depth) {
  const uint64_t cells = (uint64_t)1 << (depth <= 30 ? depth : 30);
  const uint64_t most = references < cells ? references : cells;
  const uint64_t leaves = most > 0 ? most : 1;
  const uint64_t marks = 2 * cells / 8 > 64 ? 2 * cells / 8 : 64;
  const uint64_t sizes[9] = {(uint64_t)triangles * 36,
                             (uint64_t)references * 8,
                             (uint64_t)references * 8,
                             (uint64_t)references * 4,
                             (uint64_t)references * 4,
                             leaves * 4,
                             leaves * 8,
                             marks,
                             leaves * 16};
  uint32_t* const regions[9] = {&order->scene,        &order->pairs0,     &order->pairs1,
                                &order->sorted_codes, &order->sorted_ids, &order->leaf_codes,
                                &order->leaf_rows,    &order->marks,      &order->nodes};
  uint64_t at = base;
  int i;
  if (base % 4096 != 0 || depth > 30 || references >= 1u << 29 || leaves >= 1u << 28) return 0;
  for (i = 0; i < 9; ++i) {
    *regions[i] = (uint32_t)at;
    at += ((sizes[i] > 0 ? sizes[i] : 1) + 4095) / 4096 * 4096;
    if (at > (uint64_t)1 << 32) return 0;
  }
  order->triangles = triangles;
  order->shape = depth;
  order->scene_bytes = (uint32_t)((sizes[0] + 4095) / 4096 * 4096);
  order->reference_capacity = references;
  order->leaf_capacity = (uint32_t)leaves;
  order->mark_bytes = (uint32_t)marks;
  order->rounds = 8;
  order->window_begin = base;
  order->window_end = (uint32_t)at;
  order->watchdog = 1u << 20;
  return at - base;
}

/* Writes the order and starts. The device must not be busy. */
static inline void ft_accel_start(const ft_accel* device, const ft_accel_order* order) {
  const uint32_t* const words = (const uint32_t*)order;
  uint32_t i;
  for (i = 0; i < sizeof *order / 4; ++i) {
    device->write(device->context, FT_ACCEL_ORDER + 4 * i, words[i]);
  }
  device->write(device->context, FT_ACCEL_IRQ_STATUS, 1);
  device->write(device->context, FT_ACCEL_CONTROL, FT_ACCEL_START);
}

static inline int ft_accel_busy(const ft_accel* device) {
  return (int)(device->read(device->context, FT_ACCEL_STATUS) & 1u);
}
static inline uint32_t ft_accel_stage(const ft_accel* device) {
  return device->read(device->context, FT_ACCEL_STATUS) >> 4 & 15u;
}
/* Of the last build, once it is not busy any more. */
static inline uint32_t ft_accel_error(const ft_accel* device) {
  return device->read(device->context, FT_ACCEL_STATUS) >> 8 & 255u;
}
/* The build ends soon after, with FT_ACCEL_CANCELLED. */
static inline void ft_accel_cancel(const ft_accel* device) {
  device->write(device->context, FT_ACCEL_CONTROL, FT_ACCEL_CANCEL);
}
/* After a build: writes to memory what of the marks only the cache has. For debugging; busy until
 * it is done. */
static inline void ft_accel_flush(const ft_accel* device) {
  device->write(device->context, FT_ACCEL_CONTROL, FT_ACCEL_FLUSH);
}
static inline void ft_accel_read_result(const ft_accel* device, ft_accel_result* result) {
  uint32_t* const words = (uint32_t*)result;
  uint32_t i;
  for (i = 0; i < sizeof *result / 4; ++i) {
    words[i] = device->read(device->context, FT_ACCEL_RESULT + 4 * i);
  }
}

#ifdef __cplusplus
}
#endif
#endif

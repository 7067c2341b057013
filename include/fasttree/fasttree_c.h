/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The C interface of FastTree: build a kd-tree over triangles, save it, verify it, trace rays
 * through it. C99. The C++ headers beside this one document the ideas; this one documents calls.
 *
 * Conventions
 *  - A call that can fail returns ft_status; FT_OK is 0. ft_last_error() then says what was wrong,
 *    where, and what to do. No call prints, exits or lets an exception out.
 *  - A null pointer where a thing is needed is FT_INVALID_ARGUMENT. Every *_free takes null.
 *  - On failure an output handle is set to null; other outputs are left as they were.
 *  - Structs begin with their size. Set it to sizeof the struct, best by the FT_*_INIT values. A
 *    later version may append members; sizes of this version keep working.
 *  - Handles are independent: different threads may use different handles at the same time. An
 *    ft_tree that is not being built into, and an ft_tracer, may be shared by threads.
 */
#ifndef FASTTREE_FASTTREE_C_H
#define FASTTREE_FASTTREE_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What kind of thing went wrong. */
typedef enum ft_status {
  FT_OK = 0,
  FT_INVALID_ARGUMENT = 1, /* the caller asked for something that cannot be */
  FT_BAD_INPUT = 2,        /* the data is wrong: NaN coordinates, a bad index, a damaged file */
  FT_RESOURCE_LIMIT = 3,   /* memory, disk or a limit of the format would be exceeded */
  FT_CANCELLED = 4,        /* the progress callback asked to stop */
  FT_IO_ERROR = 5          /* a file cannot be opened, read or written */
} ft_status;

/* The version of the library, such as "0.1.0". */
const char* ft_version(void);

/* An ft_status in a word, such as "bad input". Never null, whatever the number. */
const char* ft_status_name(uint32_t status);

/* What the last failing call of this thread reported; "" before the first. The text stays until the
 * thread's next failing call. Never null. */
const char* ft_last_error(void);

/* ---- Triangles ---- */

/* A view of the caller's triangles; nothing is copied. Position i is three binary32 at
 * positions + i * position_stride_bytes. Triangle t uses positions indices[3t .. 3t+2], or
 * 3t .. 3t+2 where indices is null. */
typedef struct ft_mesh {
  size_t struct_size;
  const void* positions;
  size_t position_stride_bytes;
  const uint32_t* indices;
  uint32_t vertex_count;
  uint32_t triangle_count;
} ft_mesh;

/* An empty mesh of tightly packed positions. */
#define FT_MESH_INIT \
  { sizeof(ft_mesh), NULL, 3 * sizeof(float), NULL, 0, 0 }

/* ---- Building ---- */

typedef enum ft_profile {
  FT_PROFILE_PAPER = 0,      /* grid, Morton codes, path compression: the six steps of FastTree */
  FT_PROFILE_SAH_EXACT = 1,  /* exact surface-area heuristic with perfect splits */
  FT_PROFILE_SAH_BINNED = 2, /* binned surface-area heuristic */
  FT_PROFILE_REALTIME = 3    /* least time for build plus trace */
} ft_profile;

typedef enum ft_axis_schedule {
  FT_AXES_CYCLIC = 0, /* x, y, z, x, y, z, ... */
  FT_AXES_LONGEST = 1 /* the axis whose cell is longest */
} ft_axis_schedule;

typedef enum ft_implementation {
  FT_IMPLEMENTATION_FAST = 0, /* parallel, vectorised */
  FT_IMPLEMENTATION_REFERENCE =
      1 /* the definition literally, one thread; FT_PROFILE_PAPER and _REALTIME */
} ft_implementation;

typedef enum ft_simd {
  FT_SIMD_SCALAR = 0, /* plain code */
  FT_SIMD_WIDEST = 1  /* the widest instruction set of this processor */
} ft_simd;

#define FT_AUTO_DEPTH (-1)

/* Called now and then during a build, from one thread at a time, with the stage's name and how far
 * the whole work is, 0 to 1. Return 0 to cancel, anything else to go on. */
typedef int (*ft_progress_fn)(void* user, const char* stage, double fraction);

typedef struct ft_build_settings {
  size_t struct_size;
  uint32_t profile;            /* ft_profile */
  uint32_t axes;               /* ft_axis_schedule; FT_PROFILE_PAPER only */
  int32_t depth;               /* levels of the (top) grid, 0 to 30, or FT_AUTO_DEPTH */
  int32_t extra_depth;         /* automatic depth: at most ceil(log2 N) + this; paper only */
  double max_growth;           /* the same: at most this many references a triangle */
  uint64_t memory_limit_bytes; /* that the builder may hold at once, result included; 0: no limit */
  double sah_traversal_cost;   /* of the surface-area-heuristic profiles, arbitrary units */
  double sah_intersection_cost;
  uint32_t implementation; /* ft_implementation */
  uint32_t simd;           /* ft_simd */
  uint32_t threads;        /* 0: those of the calling oneTBB arena; n: n, or as many as there are */
  uint32_t reserved;       /* 0 */
  ft_progress_fn progress; /* or null */
  void* progress_user;     /* handed to progress */
} ft_build_settings;

#define FT_BUILD_SETTINGS_INIT                                                                \
  {                                                                                           \
    sizeof(ft_build_settings), FT_PROFILE_REALTIME, FT_AXES_CYCLIC, FT_AUTO_DEPTH, 1, 6.0, 0, \
        15.0, 20.0, FT_IMPLEMENTATION_FAST, FT_SIMD_WIDEST, 0, 0, NULL, NULL                  \
  }

/* What the last build did. */
typedef struct ft_build_stats {
  size_t struct_size;
  double build_ms;
  uint64_t triangles;
  uint64_t references;    /* triangle ids in the tree */
  uint64_t planned_bytes; /* memory the plan asked for, the result included */
  uint64_t stage_count;   /* for ft_builder_get_stage */
} ft_build_stats;

#define FT_BUILD_STATS_INIT \
  { sizeof(ft_build_stats), 0.0, 0, 0, 0, 0 }

/* Builds trees and keeps its working memory for the next build. One thread at a time. */
typedef struct ft_builder ft_builder;

/* A kd-tree, in memory of its own or mapped from a file. */
typedef struct ft_tree ft_tree;

ft_status ft_builder_create(ft_builder** builder);
void ft_builder_free(ft_builder* builder);

/* Builds a tree for the mesh into *tree, to be freed with ft_tree_free. settings null: defaults. */
ft_status ft_builder_build(ft_builder* builder, const ft_mesh* mesh,
                           const ft_build_settings* settings, ft_tree** tree);

/* The same into an existing tree, whose memory is reused. FT_INVALID_ARGUMENT, with the tree as it
 * was, while a tracer uses it; after any other failure it is the tree of an empty mesh. */
ft_status ft_builder_build_into(ft_builder* builder, const ft_mesh* mesh,
                                const ft_build_settings* settings, ft_tree* tree);

ft_status ft_builder_get_stats(const ft_builder* builder, ft_build_stats* stats);

/* Name (static) and duration of a stage of the last build, in order of execution. */
ft_status ft_builder_get_stage(const ft_builder* builder, uint64_t index, const char** name,
                               double* ms);

/* Frees the working memory kept from build to build. */
void ft_builder_shrink(ft_builder* builder);

/* ---- Trees ---- */

typedef struct ft_tree_info {
  size_t struct_size;
  uint32_t profile;        /* ft_profile */
  uint32_t axes;           /* ft_axis_schedule */
  uint32_t depth;          /* levels of the grid; 0 for a tree without one */
  uint32_t triangle_count; /* of the mesh the tree was built for */
  uint64_t node_count;
  uint64_t leaf_count;
  uint64_t id_count;
  float bounds_lo[3];
  float bounds_hi[3];
  uint32_t bits[3]; /* of the grid, per axis; they sum to depth */
  uint32_t reserved;
} ft_tree_info;

/* Only the size matters; the rest is written. */
#define FT_TREE_INFO_INIT \
  { sizeof(ft_tree_info), 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0 }

void ft_tree_free(ft_tree* tree);

ft_status ft_tree_get_info(const ft_tree* tree, ft_tree_info* info);

/* The nodes, two 32-bit words each, in depth-first pre-order. The memory is the tree's.
 *   word 0, bits 0..1   axis of the split, or 3 for a leaf
 *   word 0, bits 2..31  inner: index of the upper child; leaf: number of triangles
 *   word 1              inner: the split as the bits of a binary32; leaf: first triangle id
 * The lower child of node i is node i + 1. */
ft_status ft_tree_get_nodes(const ft_tree* tree, const uint32_t** words);

/* The triangle ids that leaves point into. The memory is the tree's. */
ft_status ft_tree_get_ids(const ft_tree* tree, const uint32_t** ids);

/* XXH3 over bounds, nodes and ids: equal trees have equal hashes. */
ft_status ft_tree_get_hash(const ft_tree* tree, uint64_t* hash);

/* Writes the tree under a temporary name and renames it into place. */
ft_status ft_tree_save(const ft_tree* tree, const char* path);

/* Reads a tree file into memory. A tree from a source that is not trusted has to pass
 * ft_tree_verify before it is traced. */
ft_status ft_tree_load(const char* path, ft_tree** tree);

/* The same without copying. The file must not be changed while the tree or a tracer lives. */
ft_status ft_tree_map(const char* path, ft_tree** tree);

typedef struct ft_verification {
  size_t struct_size;
  int32_t ok;         /* 1: every invariant holds; 0: see below */
  uint32_t reserved;  /* 0 */
  uint64_t checks;    /* how many single facts were checked */
  char invariant[32]; /* name of the first broken invariant, or "" */
  char detail[256];   /* where, and what was found; shortened to fit */
} ft_verification;

#define FT_VERIFICATION_INIT \
  { sizeof(ft_verification), 0, 0, 0, "", "" }

/* Checks a tree by itself, or, where mesh is not null, also that tree and mesh belong together. A
 * broken tree is no failure of this call: it is FT_OK with ok = 0. */
ft_status ft_tree_verify(const ft_tree* tree, const ft_mesh* mesh, ft_verification* verification);

/* ---- Tracing ---- */

/* Hits are accepted for t_min <= t <= t_max. The direction need not have length 1. */
typedef struct ft_ray {
  float origin[3];
  float t_min;
  float direction[3];
  float t_max;
} ft_ray;

#define FT_NO_TRIANGLE 0xffffffffu

/* The nearest hit; at equal t the lowest triangle. triangle is FT_NO_TRIANGLE and t infinite where
 * nothing is hit. u and v weigh the triangle's second and third vertex. */
typedef struct ft_hit {
  float t;
  uint32_t triangle;
  float u;
  float v;
} ft_hit;

/* Traces rays through one tree over one mesh. Keeps the tree alive; the mesh's memory is the
 * caller's and has to outlive the tracer. */
typedef struct ft_tracer ft_tracer;

/* FT_INVALID_ARGUMENT where the tree was not built for a mesh of this many triangles. */
ft_status ft_tracer_create(const ft_tree* tree, const ft_mesh* mesh, ft_tracer** tracer);
void ft_tracer_free(ft_tracer* tracer);

/* The same in this tracer's memory, for scenes that are rebuilt every frame: take two trees in
 * turn, since the one that a tracer uses cannot be built into. threads as in ft_build_settings.
 * After a failure the tracer is as it was, or, where memory ran out, that of an empty mesh. */
ft_status ft_tracer_update(ft_tracer* tracer, const ft_tree* tree, const ft_mesh* mesh,
                           uint32_t threads);

ft_status ft_tracer_closest(const ft_tracer* tracer, const ft_ray* ray, ft_hit* hit);

/* *occluded is 1 where anything is hit, else 0. */
ft_status ft_tracer_occluded(const ft_tracer* tracer, const ft_ray* ray, uint8_t* occluded);

/* What is known of the rays of a batch: it changes the time they take, never their results. */
typedef enum ft_ray_order {
  FT_RAYS_INCOHERENT = 0, /* anything: each ray goes its own way */
  FT_RAYS_COHERENT = 1,   /* neighbours start and go nearly alike: 8 x 8 pixels, then the next */
  FT_RAY_ORDER_IS_INT = 0x7fffffff /* not an order: lets a wrong value be told from a right one */
} ft_ray_order;

/* `count` rays into `count` hits or flags. threads as in ft_build_settings. */
ft_status ft_tracer_closest_many(const ft_tracer* tracer, const ft_ray* rays, size_t count,
                                 ft_ray_order order, ft_hit* hits, uint32_t threads);
ft_status ft_tracer_occluded_many(const ft_tracer* tracer, const ft_ray* rays, size_t count,
                                  ft_ray_order order, uint8_t* occluded, uint32_t threads);

#ifdef __cplusplus
}
#endif

#endif /* FASTTREE_FASTTREE_C_H */

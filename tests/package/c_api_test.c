/* SPDX-License-Identifier: Apache-2.0 */
/* The C interface used from C99, strictly: every call once for what it is for and once for each way
 * to misuse it. Argument: a folder that can be written. */
#include <fasttree/fasttree_c.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

#define EXPECT(fact)                                                                       \
  do {                                                                                     \
    if (!(fact)) {                                                                         \
      fprintf(stderr, "%s:%d: not true: %s (last error: %s)\n", __FILE__, __LINE__, #fact, \
              ft_last_error());                                                            \
      ++failures;                                                                          \
    }                                                                                      \
  } while (0)

/* The call has to fail so, and say why. */
#define EXPECT_FAILS(call, status, part)             \
  do {                                               \
    EXPECT((call) == (status));                      \
    EXPECT(strstr(ft_last_error(), (part)) != NULL); \
  } while (0)

#define EXPECT_NULL(call) EXPECT_FAILS(call, FT_INVALID_ARGUMENT, "is null")

enum { kSide = 12, kVertices = (kSide + 1) * (kSide + 1), kTriangles = 2 * kSide * kSide };

static float positions[3 * kVertices];
static uint32_t indices[3 * kTriangles];

/* A hilly square of kSide x kSide quads over 0..1 x 0..1. */
static ft_mesh make_mesh(void) {
  ft_mesh mesh = FT_MESH_INIT;
  uint32_t x, y, i = 0;
  for (y = 0; y <= kSide; ++y) {
    for (x = 0; x <= kSide; ++x) {
      float* p = positions + 3 * (y * (kSide + 1) + x);
      p[0] = (float)x / kSide;
      p[1] = (float)y / kSide;
      p[2] = 0.1f * (float)sin(7.0 * p[0] + 5.0 * p[1]);
    }
  }
  for (y = 0; y < kSide; ++y) {
    for (x = 0; x < kSide; ++x) {
      const uint32_t a = y * (kSide + 1) + x, b = a + 1, c = a + kSide + 1, d = c + 1;
      indices[i++] = a, indices[i++] = b, indices[i++] = d;
      indices[i++] = a, indices[i++] = d, indices[i++] = c;
    }
  }
  mesh.positions = positions;
  mesh.vertex_count = kVertices;
  mesh.indices = indices;
  mesh.triangle_count = kTriangles;
  return mesh;
}

static int count_calls(void* user, const char* stage, double fraction) {
  int* calls = (int*)user;
  EXPECT(stage != NULL && stage[0] != '\0');
  EXPECT(fraction >= 0 && fraction <= 1);
  ++*calls;
  return 1;
}

static int cancel(void* user, const char* stage, double fraction) {
  (void)user, (void)stage, (void)fraction;
  return 0;
}

static void test_names(void) {
  EXPECT(strcmp(ft_version(), "") != 0);
  EXPECT(strcmp(ft_status_name(FT_OK), "ok") == 0);
  EXPECT(strcmp(ft_status_name(FT_INVALID_ARGUMENT), "invalid argument") == 0);
  EXPECT(strcmp(ft_status_name(FT_BAD_INPUT), "bad input") == 0);
  EXPECT(strcmp(ft_status_name(FT_RESOURCE_LIMIT), "resource limit") == 0);
  EXPECT(strcmp(ft_status_name(FT_CANCELLED), "cancelled") == 0);
  EXPECT(strcmp(ft_status_name(FT_IO_ERROR), "i/o error") == 0);
  EXPECT(strcmp(ft_status_name(99), "unknown status") == 0);
  EXPECT(strcmp(ft_last_error(), "") == 0);
}

static void test_build(ft_builder* builder, const ft_mesh* mesh) {
  ft_build_settings settings = FT_BUILD_SETTINGS_INIT;
  ft_build_stats stats = FT_BUILD_STATS_INIT;
  ft_tree_info info = FT_TREE_INFO_INIT;
  ft_tree* tree = NULL;
  const uint32_t *words = NULL, *ids = NULL;
  uint64_t hash = 0, first_hash = 0, i;
  const char* stage = NULL;
  double ms = -1;
  int calls = 0;
  uint32_t profile, threads;

  /* Every profile; each passes the verifier. */
  for (profile = FT_PROFILE_PAPER; profile <= FT_PROFILE_REALTIME; ++profile) {
    ft_verification v = FT_VERIFICATION_INIT;
    settings.profile = profile;
    EXPECT(ft_builder_build(builder, mesh, &settings, &tree) == FT_OK);
    EXPECT(ft_tree_verify(tree, mesh, &v) == FT_OK);
    EXPECT(v.ok == 1 && v.checks > kTriangles && v.invariant[0] == '\0' && v.detail[0] == '\0');
    EXPECT(ft_tree_verify(tree, NULL, &v) == FT_OK && v.ok == 1);
    EXPECT(ft_tree_get_info(tree, &info) == FT_OK);
    EXPECT(info.profile == profile);
    ft_tree_free(tree);
  }

  /* Null settings are the defaults; threads change nothing in the result. */
  EXPECT(ft_builder_build(builder, mesh, NULL, &tree) == FT_OK);
  EXPECT(ft_tree_get_hash(tree, &first_hash) == FT_OK);
  settings.profile = FT_PROFILE_REALTIME;
  settings.progress = count_calls;
  settings.progress_user = &calls;
  for (threads = 1; threads <= 3; ++threads) {
    settings.threads = threads;
    EXPECT(ft_builder_build_into(builder, mesh, &settings, tree) == FT_OK);
    EXPECT(ft_tree_get_hash(tree, &hash) == FT_OK);
    EXPECT(hash == first_hash);
  }
  EXPECT(calls > 0);

  EXPECT(ft_tree_get_info(tree, &info) == FT_OK);
  EXPECT(info.struct_size == sizeof info);
  EXPECT(info.triangle_count == kTriangles);
  EXPECT(info.node_count == 2 * info.leaf_count - 1);
  EXPECT(info.bits[0] + info.bits[1] + info.bits[2] == info.depth && info.depth == 0);
  EXPECT(info.bounds_lo[0] == 0 && info.bounds_hi[1] == 1 && info.bounds_lo[2] < 0);
  EXPECT(ft_tree_get_nodes(tree, &words) == FT_OK);
  EXPECT(ft_tree_get_ids(tree, &ids) == FT_OK);
  EXPECT((words[0] & 3) < 3 && words[0] >> 2 < info.node_count);
  EXPECT((words[2 * (info.node_count - 1)] & 3) == 3);
  for (i = 0; i < info.id_count; ++i) EXPECT(ids[i] < kTriangles);

  EXPECT(ft_builder_get_stats(builder, &stats) == FT_OK);
  EXPECT(stats.triangles == kTriangles && stats.references == info.id_count);
  EXPECT(stats.build_ms >= 0 && stats.stage_count > 0);
  for (i = 0; i < stats.stage_count; ++i) {
    EXPECT(ft_builder_get_stage(builder, i, &stage, &ms) == FT_OK);
    EXPECT(stage != NULL && ms >= 0);
  }
  EXPECT_FAILS(ft_builder_get_stage(builder, stats.stage_count, &stage, &ms), FT_INVALID_ARGUMENT,
               "stage");

  /* Failures leave the tree of an empty mesh. */
  settings.progress = cancel;
  EXPECT_FAILS(ft_builder_build_into(builder, mesh, &settings, tree), FT_CANCELLED, "cancelled");
  EXPECT(ft_tree_get_info(tree, &info) == FT_OK && info.node_count == 1 && info.id_count == 0);
  ft_builder_shrink(builder);
  settings.progress = NULL;
  settings.memory_limit_bytes = 100;
  EXPECT(ft_builder_build_into(builder, mesh, &settings, tree) == FT_RESOURCE_LIMIT);
  ft_tree_free(tree);
}

static void test_bad_arguments(ft_builder* builder, const ft_mesh* mesh) {
  struct {
    ft_build_settings settings;
    uint64_t later; /* leaves no padding, whose bytes would be anything */
  } grown = {FT_BUILD_SETTINGS_INIT, 0};
  ft_build_settings settings = FT_BUILD_SETTINGS_INIT;
  const ft_build_settings defaults = FT_BUILD_SETTINGS_INIT;
  ft_mesh bad = *mesh;
  ft_tree* tree = NULL;

  EXPECT_NULL(ft_builder_create(NULL));
  EXPECT_NULL(ft_builder_build(NULL, mesh, NULL, &tree));
  EXPECT_NULL(ft_builder_build(builder, NULL, NULL, &tree));
  EXPECT_NULL(ft_builder_build(builder, mesh, NULL, NULL));
  EXPECT_NULL(ft_builder_build_into(NULL, mesh, NULL, tree));
  EXPECT_NULL(ft_builder_build_into(builder, mesh, NULL, NULL));
  EXPECT_NULL(ft_builder_get_stats(builder, NULL));
  EXPECT_NULL(ft_builder_get_stats(NULL, NULL));
  EXPECT_NULL(ft_builder_get_stage(NULL, 0, NULL, NULL));
  EXPECT_NULL(ft_builder_get_stage(builder, 0, NULL, NULL));

  settings.struct_size = sizeof settings - 1;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT,
               "struct_size");
  settings = defaults;
  settings.profile = 4;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "profile");
  settings.profile = 256; /* not taken for its low byte */
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "profile");
  settings = defaults;
  settings.axes = 2;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "axes");
  settings = defaults;
  settings.implementation = 2;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT,
               "implementation");
  settings = defaults;
  settings.simd = 2;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "simd");
  settings = defaults;
  settings.threads = 5000;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "threads");
  settings = defaults;
  settings.depth = 31;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &settings, &tree), FT_INVALID_ARGUMENT, "depth");

  /* A caller of a later version is served as long as it asks for nothing new. */
  grown.settings.struct_size = sizeof grown;
  EXPECT(ft_builder_build(builder, mesh, &grown.settings, &tree) == FT_OK);
  ft_tree_free(tree);
  tree = NULL;
  grown.later = 1;
  EXPECT_FAILS(ft_builder_build(builder, mesh, &grown.settings, &tree), FT_INVALID_ARGUMENT,
               "does not know");

  bad.struct_size = 0;
  EXPECT_FAILS(ft_builder_build(builder, &bad, NULL, &tree), FT_INVALID_ARGUMENT, "struct_size");
  bad = *mesh;
  bad.positions = NULL;
  EXPECT(ft_builder_build(builder, &bad, NULL, &tree) == FT_INVALID_ARGUMENT);
  bad = *mesh;
  bad.vertex_count = 3;
  EXPECT(ft_builder_build(builder, &bad, NULL, &tree) == FT_BAD_INPUT);
  EXPECT(tree == NULL);
}

static void test_files(ft_builder* builder, const ft_mesh* mesh, const char* folder) {
  char path[4096];
  ft_tree *tree = NULL, *again = NULL;
  ft_verification v = FT_VERIFICATION_INIT;
  uint64_t hash = 0, hash_again = 0;
  FILE* file;

  snprintf(path, sizeof path, "%s/c_api_test.tree", folder);
  EXPECT(ft_builder_build(builder, mesh, NULL, &tree) == FT_OK);
  EXPECT(ft_tree_get_hash(tree, &hash) == FT_OK);
  EXPECT(ft_tree_save(tree, path) == FT_OK);
  EXPECT(ft_tree_load(path, &again) == FT_OK);
  EXPECT(ft_tree_get_hash(again, &hash_again) == FT_OK && hash == hash_again);
  ft_tree_free(again);
  EXPECT(ft_tree_map(path, &again) == FT_OK);
  EXPECT(ft_tree_get_hash(again, &hash_again) == FT_OK && hash == hash_again);
  EXPECT(ft_tree_verify(again, mesh, &v) == FT_OK && v.ok == 1);

  /* The verdict on another mesh is no failure of the call. */
  {
    ft_mesh fewer = *mesh;
    --fewer.triangle_count;
    EXPECT(ft_tree_verify(again, &fewer, &v) == FT_OK);
    EXPECT(v.ok == 0 && strcmp(v.invariant, "mesh-triangle-count") == 0 && v.detail[0] != '\0');
    v.struct_size = 8;
    EXPECT_FAILS(ft_tree_verify(again, NULL, &v), FT_INVALID_ARGUMENT, "struct_size");
  }
  ft_tree_free(again);

  file = fopen(path, "r+b");
  EXPECT(file != NULL && fseek(file, 200, SEEK_SET) == 0 && fputc(0xff, file) != EOF);
  EXPECT(file != NULL && fclose(file) == 0);
  EXPECT_FAILS(ft_tree_load(path, &again), FT_BAD_INPUT, "checksum");
  EXPECT(again == NULL);
  EXPECT(remove(path) == 0);
  EXPECT_FAILS(ft_tree_map(path, &again), FT_IO_ERROR, "No such file");

  EXPECT_NULL(ft_tree_save(NULL, path));
  EXPECT_NULL(ft_tree_save(tree, NULL));
  EXPECT_NULL(ft_tree_load(NULL, &again));
  EXPECT_NULL(ft_tree_load(path, NULL));
  EXPECT_NULL(ft_tree_map(NULL, &again));
  EXPECT_NULL(ft_tree_map(path, NULL));
  EXPECT_NULL(ft_tree_get_info(NULL, NULL));
  EXPECT_NULL(ft_tree_get_info(tree, NULL));
  EXPECT_NULL(ft_tree_get_nodes(NULL, NULL));
  EXPECT_NULL(ft_tree_get_nodes(tree, NULL));
  EXPECT_NULL(ft_tree_get_ids(NULL, NULL));
  EXPECT_NULL(ft_tree_get_ids(tree, NULL));
  EXPECT_NULL(ft_tree_get_hash(NULL, &hash));
  EXPECT_NULL(ft_tree_get_hash(tree, NULL));
  EXPECT_NULL(ft_tree_verify(NULL, mesh, &v));
  EXPECT_NULL(ft_tree_verify(tree, mesh, NULL));
  ft_tree_free(tree);
}

enum { kRays = 1000 };

static void test_trace(ft_builder* builder, const ft_mesh* mesh) {
  static ft_ray rays[kRays];
  static ft_hit hits[kRays];
  static uint8_t flags[kRays];
  ft_tree* tree = NULL;
  ft_tracer* tracer = NULL;
  ft_mesh fewer = *mesh;
  uint32_t pass;
  int i, hit_count = 0;

  EXPECT(ft_builder_build(builder, mesh, NULL, &tree) == FT_OK);
  --fewer.triangle_count;
  EXPECT(ft_tracer_create(tree, &fewer, &tracer) == FT_INVALID_ARGUMENT && tracer == NULL);
  fewer = *mesh;
  fewer.vertex_count = 3;
  EXPECT(ft_tracer_create(tree, &fewer, &tracer) == FT_BAD_INPUT && tracer == NULL);
  EXPECT_NULL(ft_tracer_create(NULL, mesh, &tracer));
  EXPECT_NULL(ft_tracer_create(tree, NULL, &tracer));
  EXPECT_NULL(ft_tracer_create(tree, mesh, NULL));

  EXPECT(ft_tracer_create(tree, mesh, &tracer) == FT_OK);
  EXPECT_FAILS(ft_builder_build_into(builder, mesh, NULL, tree), FT_INVALID_ARGUMENT, "tracer");
  ft_tree_free(tree); /* the tracer keeps what it needs */

  for (i = 0; i < kRays; ++i) { /* straight down, a quarter of them beside the square */
    ft_ray* r = rays + i;
    r->origin[0] = (float)(i % 40) / 30 - 0.0001f;
    r->origin[1] = (float)(i / 40) / 25 + 0.01f;
    r->origin[2] = 1;
    r->direction[0] = r->direction[1] = 0;
    r->direction[2] = -1;
    r->t_min = 0;
    r->t_max = 10;
  }
  for (pass = 0; pass < 6; ++pass) {
    const uint32_t threads = pass / 2;
    const ft_ray_order order = pass % 2 ? FT_RAYS_COHERENT : FT_RAYS_INCOHERENT;
    memset(hits, 0, sizeof hits);
    memset(flags, 7, sizeof flags);
    EXPECT(ft_tracer_closest_many(tracer, rays, kRays, order, hits, threads) == FT_OK);
    EXPECT(ft_tracer_occluded_many(tracer, rays, kRays, order, flags, threads) == FT_OK);
    hit_count = 0;
    for (i = 0; i < kRays; ++i) {
      const float x = rays[i].origin[0], y = rays[i].origin[1];
      const int inside = x >= 0 && x <= 1 && y >= 0 && y <= 1;
      ft_hit one = {0, 0, 0, 0};
      uint8_t flag = 9;
      EXPECT(ft_tracer_closest(tracer, rays + i, &one) == FT_OK);
      EXPECT(ft_tracer_occluded(tracer, rays + i, &flag) == FT_OK);
      EXPECT(one.t == hits[i].t && one.triangle == hits[i].triangle && one.u == hits[i].u &&
             one.v == hits[i].v);
      EXPECT(flag == flags[i] && flag == inside);
      EXPECT((hits[i].triangle != FT_NO_TRIANGLE) == inside);
      if (inside) {
        ++hit_count;
        EXPECT(hits[i].t >= 0.9f && hits[i].t <= 1.1f);
      }
    }
  }
  EXPECT(hit_count > kRays / 2 && hit_count < kRays);

  EXPECT(ft_tracer_closest_many(tracer, NULL, 0, FT_RAYS_COHERENT, NULL, 0) == FT_OK);
  EXPECT(ft_tracer_occluded_many(tracer, NULL, 0, FT_RAYS_COHERENT, NULL, 0) == FT_OK);
  EXPECT_NULL(ft_tracer_closest(NULL, rays, hits));
  EXPECT_NULL(ft_tracer_closest(tracer, NULL, hits));
  EXPECT_NULL(ft_tracer_closest(tracer, rays, NULL));
  EXPECT_NULL(ft_tracer_occluded(NULL, rays, flags));
  EXPECT_NULL(ft_tracer_occluded(tracer, NULL, flags));
  EXPECT_NULL(ft_tracer_occluded(tracer, rays, NULL));
  EXPECT_NULL(ft_tracer_closest_many(NULL, rays, 1, FT_RAYS_COHERENT, hits, 0));
  EXPECT_NULL(ft_tracer_closest_many(tracer, NULL, 1, FT_RAYS_COHERENT, hits, 0));
  EXPECT_NULL(ft_tracer_closest_many(tracer, rays, 1, FT_RAYS_COHERENT, NULL, 0));
  EXPECT_NULL(ft_tracer_occluded_many(tracer, rays, 1, FT_RAYS_COHERENT, NULL, 0));
  EXPECT_FAILS(ft_tracer_closest_many(tracer, rays, 1, FT_RAYS_INCOHERENT, hits, 5000),
               FT_INVALID_ARGUMENT, "threads");
  EXPECT_FAILS(ft_tracer_closest_many(tracer, rays, 1, (ft_ray_order)2, hits, 0),
               FT_INVALID_ARGUMENT, "order");

  /* another frame: a tree beside the one in use, then the tracer goes over to it */
  EXPECT(ft_builder_build(builder, mesh, NULL, &tree) == FT_OK);
  EXPECT_NULL(ft_tracer_update(NULL, tree, mesh, 0));
  EXPECT_NULL(ft_tracer_update(tracer, NULL, mesh, 0));
  EXPECT_NULL(ft_tracer_update(tracer, tree, NULL, 0));
  fewer = *mesh;
  --fewer.triangle_count;
  EXPECT_FAILS(ft_tracer_update(tracer, tree, &fewer, 0), FT_INVALID_ARGUMENT, "triangles");
  EXPECT(ft_tracer_closest(tracer, rays, hits) == FT_OK); /* as it was */
  EXPECT(ft_tracer_update(tracer, tree, mesh, 1) == FT_OK);
  EXPECT_FAILS(ft_builder_build_into(builder, mesh, NULL, tree), FT_INVALID_ARGUMENT, "tracer");
  ft_tree_free(tree);
  for (i = 0; i < kRays; ++i) {
    ft_hit one = {0, 0, 0, 0};
    EXPECT(ft_tracer_closest(tracer, rays + i, &one) == FT_OK);
    EXPECT(i == 0 || (one.t == hits[i].t && one.triangle == hits[i].triangle));
  }
  ft_tracer_free(tracer);
}

int main(int argc, char** argv) {
  const ft_mesh mesh = make_mesh();
  ft_builder* builder = NULL;
  if (argc != 2) {
    fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  test_names();
  EXPECT(ft_builder_create(&builder) == FT_OK);
  test_build(builder, &mesh);
  test_bad_arguments(builder, &mesh);
  test_files(builder, &mesh, argv[1]);
  test_trace(builder, &mesh);
  ft_builder_free(builder);
  ft_builder_free(NULL);
  ft_tree_free(NULL);
  ft_tracer_free(NULL);
  ft_builder_shrink(NULL);
  if (failures == 0) puts("ok");
  return failures == 0 ? 0 : 1;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The same as consumer.cpp, through the C interface. */
#include <fasttree/fasttree_c.h>
#include <stdio.h>

int main(void) {
  /* A square in the plane z = 2, as two triangles. */
  static const float positions[] = {0, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1, 2};
  static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
  const ft_ray ray = {{0.75f, 0.25f, 0}, 0, {0, 0, 1}, 1e30f};

  ft_mesh mesh = FT_MESH_INIT;
  ft_builder* builder = NULL;
  ft_tree* tree = NULL;
  ft_tracer* tracer = NULL;
  ft_hit hit = {0, FT_NO_TRIANGLE, 0, 0};
  uint64_t hash = 0;
  ft_status status;

  mesh.positions = positions;
  mesh.vertex_count = 4;
  mesh.indices = indices;
  mesh.triangle_count = 2;

  status = ft_builder_create(&builder);
  if (status == FT_OK) status = ft_builder_build(builder, &mesh, NULL, &tree);
  if (status == FT_OK) status = ft_tree_get_hash(tree, &hash);
  if (status == FT_OK) status = ft_tracer_create(tree, &mesh, &tracer);
  if (status == FT_OK) status = ft_tracer_closest(tracer, &ray, &hit);
  if (status != FT_OK) {
    fprintf(stderr, "%s: %s\n", ft_status_name(status), ft_last_error());
  } else {
    printf("tree %08lx%08lx: triangle %lu at t = %g\n", (unsigned long)(hash >> 32),
           (unsigned long)(hash & 0xffffffffu), (unsigned long)hit.triangle, (double)hit.t);
  }

  ft_tracer_free(tracer);
  ft_tree_free(tree);
  ft_builder_free(builder);
  return status == FT_OK && hit.triangle == 0 && hit.t == 2.0f ? 0 : 1;
}

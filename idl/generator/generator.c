/* The back end that idlc loads with `-l libcycloneddsidlkervan.so`. For pkg/msg/Name.idl it writes pkg/msg/Name.hpp,
   Name.cpp and Name.d (the IDL files it depends on, for the build). If anything is refused it writes nothing. */
#include "idlc/generator.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cpp.h"
#include "idl/file.h"

static char *output_path(const idl_pstate_t *state, const idlc_generator_config_t *config, const char *suffix) {
  char *path = NULL;
  if (idl_generate_out_file(state->sources->path->name, config->output_dir, config->base_dir, suffix, &path, 0) < 0)
    return NULL;
  return path;
}

static int write_file(const char *path, const text_t *text) {
  FILE *file = fopen(path, "wb");
  if (!file) {
    fprintf(stderr, "%s: error: cannot be written\n", path);
    return IDL_RETCODE_NO_ACCESS;
  }
  const size_t written = fwrite(text->data, 1, text->length, file);
  if (fclose(file) != 0 || written != text->length) {
    fprintf(stderr, "%s: error: cannot be written completely\n", path);
    remove(path);
    return IDL_RETCODE_NO_SPACE;
  }
  return IDL_RETCODE_OK;
}

static void add_sources(text_t *out, const idl_source_t *source) {
  for (; source; source = source->next) {
    text_add(out, " \\\n  %s", source->path->name);
    add_sources(out, source->includes);
  }
}

static int generate_files(const idl_pstate_t *state, char *header_path, char *source_path, char *dependency_path,
                          const char *self) {
  text_t header = {NULL, 0, 0}, source = {NULL, 0, 0}, dependencies = {NULL, 0, 0};
  add_header(&header, state, self);
  add_source(&source, state, self);
  text_add(&dependencies, "%s %s:", header_path, source_path);
  add_sources(&dependencies, state->sources);
  text_add(&dependencies, "\n");

  int result = write_file(header_path, &header);
  if (result == IDL_RETCODE_OK) result = write_file(source_path, &source);
  if (result == IDL_RETCODE_OK) result = write_file(dependency_path, &dependencies);
  text_free(&header);
  text_free(&source);
  text_free(&dependencies);
  return result;
}

__attribute__((visibility("default"))) int generate(const idl_pstate_t *state, const idlc_generator_config_t *config);

int generate(const idl_pstate_t *state, const idlc_generator_config_t *config) {
  if (check(state) > 0) return IDL_RETCODE_UNSUPPORTED;

  text_t self = {NULL, 0, 0};
  add_file_name(&self, state->sources->path->name);
  char *header = output_path(state, config, "hpp");
  char *source = output_path(state, config, "cpp");
  char *dependencies = output_path(state, config, "d");
  const int result = header && source && dependencies ? generate_files(state, header, source, dependencies, self.data)
                                                      : IDL_RETCODE_NO_MEMORY;
  free(header);
  free(source);
  free(dependencies);
  text_free(&self);
  return result;
}

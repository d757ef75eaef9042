#include "model.h"

#include <string.h>

bool in_main_file(const idl_pstate_t *state, const void *node) {
  const idl_location_t *location = idl_location(node);
  return strcmp(location->first.source->path->name, state->sources->path->name) == 0;
}

static void visit_definitions(const idl_pstate_t *state, const void *first, void (*visit)(const void *, void *),
                              void *argument) {
  for (const void *node = first; node; node = idl_next(node)) {
    if (idl_is_module(node))
      visit_definitions(state, ((const idl_module_t *)node)->definitions, visit, argument);
    else if (in_main_file(state, node))
      visit(node, argument);
  }
}

void for_each_definition(const idl_pstate_t *state, void (*visit)(const void *, void *), void *argument) {
  visit_definitions(state, state->root, visit, argument);
}

void add_file_name(text_t *out, const char *path) {
  const char *begin = path + strlen(path);
  for (int slashes = 0; begin > path; --begin)
    if (begin[-1] == '/' && ++slashes == 3) break;
  const char *suffix = strrchr(begin, '.');
  text_add(out, "%.*s", suffix ? (int)(suffix - begin) : (int)strlen(begin), begin);
}

void add_scope(text_t *out, const void *node, const char *separator) {
  const void *parent = idl_parent(node);
  while (parent && !idl_is_module(parent)) parent = idl_parent(parent);
  if (!parent) return;
  text_t outer = {NULL, 0, 0};
  add_scope(&outer, parent, separator);
  if (outer.length) text_add(out, "%s%s", outer.data, separator);
  text_add(out, "%s", idl_identifier(parent));
  text_free(&outer);
}

void add_scoped_name(text_t *out, const void *node, const char *separator) {
  const size_t before = out->length;
  add_scope(out, node, separator);
  text_add(out, "%s%s", out->length > before ? separator : "", idl_identifier(node));
}

bool next_field(const idl_struct_t *type, field_t *field) {
  if (!field->member) {
    field->member = type->members;
  } else if ((field->declarator = idl_next(field->declarator)) != NULL) {
    return true;
  } else {
    field->member = idl_next(field->member);
  }
  field->declarator = field->member ? field->member->declarators : NULL;
  return field->member != NULL;
}

const idl_type_spec_t *innermost_type(const idl_type_spec_t *type) {
  return idl_strip(type, IDL_STRIP_ALIASES | IDL_STRIP_ALIASES_ARRAY | IDL_STRIP_FORWARD);
}

const idl_type_spec_t *element_type(const idl_type_spec_t *type) {
  type = innermost_type(type);
  while (idl_is_sequence(type)) type = innermost_type(idl_type_spec(type));
  return type;
}

bool is_keyed(const idl_struct_t *type) {
  for (field_t field = {NULL, NULL}; next_field(type, &field);)
    if (field.member->key.value) return true;
  return false;
}

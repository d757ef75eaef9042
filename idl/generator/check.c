#include "check.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "model.h"

typedef struct checker {
  const idl_pstate_t *state;
  const char *file; /* being compiled, in the ROS 2 layout, without the suffix */
  int refusals;
  bool has_main_struct; /* of the file's own name, by which the package's list of types finds it */
} checker_t;

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static void
refuse(checker_t *checker, const void *symbol, const char *format, ...) {
  const idl_position_t *place = &idl_location(symbol)->first;
  fprintf(stderr, "%s:%" PRIu32 ":%" PRIu32 ": error: ", place->file->name, place->line, place->column);
  va_list arguments;
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputc('\n', stderr);
  ++checker->refusals;
}

static bool is_one_of(const char *word, const char *const *words) {
  for (; *words; ++words)
    if (strcmp(word, *words) == 0) return true;
  return false;
}

/* Words idlc lets through and a C or C++ compiler does not: keywords, and macros of the standard headers. */
static const char *const reserved[] = {"alignas",      "alignof",   "and",          "and_eq",
                                       "asm",          "assert",    "auto",         "bitand",
                                       "bitor",        "bool",      "break",        "case",
                                       "catch",        "char",      "char16_t",     "char32_t",
                                       "char8_t",      "class",     "co_await",     "co_return",
                                       "co_yield",     "compl",     "concept",      "const",
                                       "const_cast",   "consteval", "constexpr",    "constinit",
                                       "continue",     "decltype",  "default",      "delete",
                                       "do",           "double",    "dynamic_cast", "else",
                                       "enum",         "EOF",       "errno",        "explicit",
                                       "export",       "extern",    "false",        "float",
                                       "for",          "friend",    "goto",         "if",
                                       "inline",       "int",       "linux",        "long",
                                       "mutable",      "namespace", "new",          "noexcept",
                                       "not",          "not_eq",    "NULL",         "nullptr",
                                       "operator",     "or",        "or_eq",        "private",
                                       "protected",    "public",    "register",     "reinterpret_cast",
                                       "requires",     "restrict",  "return",       "short",
                                       "signed",       "sizeof",    "static",       "static_assert",
                                       "static_cast",  "stderr",    "stdin",        "stdout",
                                       "struct",       "switch",    "template",     "this",
                                       "thread_local", "throw",     "true",         "try",
                                       "typedef",      "typeid",    "typename",     "typeof",
                                       "union",        "unix",      "unsigned",     "using",
                                       "virtual",      "void",      "volatile",     "wchar_t",
                                       "while",        "xor",       "xor_eq",       NULL};

/* Names of the functions every message has beside it. */
static const char *const taken[] = {"fields", "is_valid", "to_string", NULL};

static void check_name(checker_t *checker, const void *declaration, const char *what) {
  const char *name = idl_identifier(declaration);
  const idl_name_t *symbol = idl_name(declaration);
  const void *place = symbol ? (const void *)symbol : declaration;
  if (is_one_of(name, reserved))
    refuse(checker, place, "%s '%s' is a reserved word of C or C++: choose another name, e.g. '%s_'", what, name, name);
  else if (is_one_of(name, taken))
    refuse(checker, place, "%s '%s' is the name of a generated function: choose another name", what, name);
  else if (strstr(name, "__"))
    refuse(checker, place, "%s '%s': names with two underscores belong to the C++ compiler: use one", what, name);
}

/* To idlc such a member hides the annotation from the members after it, which it then drops without a word. */
static const char *const annotations[] = {"key", "unit", NULL};

/* An annotation without effect here would promise something to whoever reads the IDL; so it is refused. */
static void check_annotations(checker_t *checker, const void *node, const char *const *supported, const char *what) {
  const idl_annotation_appl_t *annotation = ((const idl_node_t *)node)->annotations;
  for (; annotation; annotation = idl_next(annotation)) {
    const char *name = annotation->annotation->name->identifier;
    if (is_one_of(name, supported)) continue;
    if (strcmp(name, "optional") == 0)
      refuse(checker, annotation,
             "@optional is not supported, ROS 2 readers cannot match it: use a sequence of at most "
             "one element, or a boolean member beside the value");
    else if (strcmp(name, "external") == 0)
      refuse(checker, annotation, "@external is not supported: leave it out, the value is stored in place");
    else if (strcmp(name, "bit_bound") == 0)
      refuse(checker, annotation, "@bit_bound is not supported: leave it out, an enum has 32 bits on the wire");
    else if (strcmp(name, "default") == 0)
      refuse(checker, annotation, "@default is not supported, every fresh value is zero: leave it out");
    else if (strcmp(name, "appendable") == 0 || strcmp(name, "mutable") == 0)
      refuse(checker, annotation, "@%s is not supported, ROS 2 readers cannot match it: write @final", name);
    else
      refuse(checker, annotation, "annotation @%s on %s is not supported: leave it out", name, what);
  }
}

/* Refuses what no member may be made of. Typedefs are looked through, so that the place is always the member's. */
static void check_type(checker_t *checker, const void *place, const idl_type_spec_t *type, const char *what) {
  type = innermost_type(type);
  if (idl_is_sequence(type)) {
    const idl_type_spec_t *element = innermost_type(idl_type_spec(type));
    if (((const idl_sequence_t *)type)->maximum)
      refuse(checker, place, "%s: bounded sequences are not supported: use sequence<T> or an array", what);
    if (idl_type(element) == IDL_BOOL)
      refuse(checker, place, "%s: sequence<boolean> is not supported, C++ packs it into bits: use sequence<octet>",
             what);
    check_type(checker, place, element, what);
  } else if (idl_is_bounded_string(type)) {
    refuse(checker, place, "%s: bounded strings are not supported: use string", what);
  } else if (idl_is_union(type)) {
    refuse(checker, place, "%s: unions are not supported: use a struct with an enum that says which members hold",
           what);
  } else if (idl_is_bitmask(type)) {
    refuse(checker, place, "%s: bitmasks are not supported: use uint32 and constants", what);
  } else if (idl_type(type) == IDL_WCHAR || idl_type(type) == IDL_WSTRING) {
    refuse(checker, place, "%s: wide characters are not supported: use string, it holds UTF-8", what);
  } else if (idl_type(type) == IDL_LDOUBLE) {
    refuse(checker, place, "%s: long double is not supported: use double", what);
  } else if (idl_type(type) == IDL_ANY || idl_type(type) == IDL_FIXED_PT) {
    refuse(checker, place, "%s: this type is not supported: use an integer, double, string, struct or sequence", what);
  }
}

/* A key decides which instance a sample belongs to, so it must compare exactly and be cheap to copy. */
static void check_key(checker_t *checker, const void *place, const idl_type_spec_t *type, const char *name) {
  const bool array = idl_is_array(type);
  type = innermost_type(type);
  if (array || idl_is_sequence(type) || idl_is_floating_pt_type(type)) {
    refuse(checker, place, "@key on '%s': a key is an integer, boolean, enum, string, or a struct of these", name);
  } else if (idl_is_struct(type)) {
    const bool explicit_keys = is_keyed(type);
    for (field_t field = {NULL, NULL}; next_field(type, &field);) {
      if (explicit_keys && !field.member->key.value) continue;
      if (idl_is_array(field.declarator))
        refuse(checker, place, "@key on '%s': a key is an integer, boolean, enum, string, or a struct of these", name);
      else
        check_key(checker, place, field.member->type_spec, name);
    }
  }
}

static void check_struct(checker_t *checker, const idl_struct_t *type) {
  static const char *const on_structs[] = {"final", "topic", "nested", NULL};
  static const char *const on_members[] = {"key", "unit", NULL};
  text_t what = {NULL, 0, 0};

  check_name(checker, type, "struct");
  check_annotations(checker, type, on_structs, "a struct");
  if (!type->extensibility.annotation)
    refuse(checker, type->name, "struct '%s' is not @final: write @final before it, ROS 2 readers match nothing else",
           idl_identifier(type));
  if (type->inherit_spec)
    refuse(checker, type->name, "struct '%s' inherits: inheritance is not supported, make the base a member",
           idl_identifier(type));
  if (!type->members)
    refuse(checker, type->name, "struct '%s' has no member: give it one, an empty struct has no bytes on the wire",
           idl_identifier(type));

  for (const idl_member_t *member = type->members; member; member = idl_next(member))
    check_annotations(checker, member, on_members, "a member");

  for (field_t field = {NULL, NULL}; next_field(type, &field);) {
    const char *name = idl_identifier(field.declarator);
    const idl_name_t *place = field.declarator->name;
    check_name(checker, field.declarator, "member");
    if (is_one_of(name, annotations))
      refuse(checker, place,
             "member '%s' hides the annotation @%s: choose another name, ROS 2 compares types, not names", name, name);

    what.length = 0;
    text_add(&what, "member '%s'", name);
    check_type(checker, place, field.member->type_spec, what.data);

    const idl_type_spec_t *element = element_type(field.member->type_spec);
    if (idl_is_floating_pt_type(element) && !field.member->unit.annotation)
      refuse(checker, place,
             "member '%s' has no unit: write @unit(\"m\"), or whichever it is, before its type, and "
             "@unit(\"1\") for a pure number",
             name);
    if (field.member->key.value) {
      if (idl_is_array(field.declarator))
        refuse(checker, place, "@key on '%s': a key is an integer, boolean, enum, string, or a struct of these", name);
      else
        check_key(checker, place, field.member->type_spec, name);
    }
  }
  text_free(&what);
}

static void check_enum(checker_t *checker, const idl_enum_t *type) {
  static const char *const on_enums[] = {"final", NULL};
  static const char *const on_enumerators[] = {"value", NULL};
  bool has_zero = false;
  check_name(checker, type, "enum");
  check_annotations(checker, type, on_enums, "an enum");
  for (const idl_enumerator_t *e = type->enumerators; e; e = idl_next(e)) {
    check_name(checker, e, "enumerator");
    check_annotations(checker, e, on_enumerators, "an enumerator");
    if (e->value.value == 0) has_zero = true;
    if (e->value.value > INT32_MAX)
      refuse(checker, e->name, "enumerator '%s' does not fit 32 bits with a sign: choose a smaller value",
             idl_identifier(e));
  }
  if (!has_zero)
    refuse(checker, type->name, "enum '%s' has no enumerator with value 0: add one, a fresh message holds it",
           idl_identifier(type));
}

/* Whether a scope begins with the folders of its file: "a::msg" or "a::msg::X_Constants" for "a/msg/X". */
static bool is_in_folders(const char *file, const char *scope) {
  for (; *file; ++file, ++scope) {
    if (*file != '/') {
      if (*file != *scope) return false;
    } else {
      if (!strchr(file + 1, '/')) return *scope == '\0' || *scope == ':';
      if (scope[0] != ':' || scope[1] != ':') return false;
      ++scope;
    }
  }
  return false;
}

static void check_definition(const void *node, void *argument) {
  checker_t *checker = argument;
  text_t scope = {NULL, 0, 0};
  add_scope(&scope, node, "::");
  if (!scope.length) {
    refuse(checker, node, "%s outside of a module: put it into `module <package> { module msg { ... }; };`",
           idl_construct(node));
  } else if (!is_in_folders(checker->file, scope.data)) {
    refuse(checker, node,
           "module %s in the file %s.idl: modules and folders must agree, as in <package>/msg/<Name>.idl", scope.data,
           checker->file);
  }
  text_free(&scope);

  if (idl_is_forward(node)) {
    refuse(checker, node,
           "forward declarations are not supported: define the struct before it is used, and let a tree "
           "refer to its nodes by index");
  } else if (idl_is_struct(node)) {
    const char *name = strrchr(checker->file, '/');
    if (strcmp(idl_identifier(node), name ? name + 1 : checker->file) == 0) checker->has_main_struct = true;
    check_struct(checker, node);
  } else if (idl_is_enum(node)) {
    check_enum(checker, node);
  } else if (idl_is_union(node)) {
    refuse(checker, ((const idl_union_t *)node)->name,
           "union '%s': unions are not supported: use a struct with an enum that says which members hold",
           idl_identifier(node));
  } else if (idl_is_bitmask(node)) {
    refuse(checker, ((const idl_bitmask_t *)node)->name,
           "bitmask '%s': bitmasks are not supported: use uint32 and constants", idl_identifier(node));
  } else if (idl_is_const(node)) {
    check_name(checker, node, "constant");
  }
}

/* Modules are not definitions of their own, and an included file's modules are that file's business. */
static void check_module_names(checker_t *checker, const void *first) {
  for (const void *node = first; node; node = idl_next(node)) {
    if (!idl_is_module(node)) continue;
    if (in_main_file(checker->state, node)) check_name(checker, node, "module");
    check_module_names(checker, ((const idl_module_t *)node)->definitions);
  }
}

int check(const idl_pstate_t *state) {
  text_t file = {NULL, 0, 0};
  add_file_name(&file, state->sources->path->name);
  checker_t checker = {state, file.data, 0, false};
  check_module_names(&checker, state->root);
  for_each_definition(state, check_definition, &checker);
  if (!checker.refusals && !checker.has_main_struct) {
    const char *name = strrchr(file.data, '/');
    name = name ? name + 1 : file.data;
    fprintf(stderr,
            "%s:1:1: error: the file defines no struct '%s': a file has the name of its struct; an enum or constant "
            "lives with a struct that uses it\n",
            state->sources->file->name, name);
    ++checker.refusals;
  }
  text_free(&file);
  return checker.refusals;
}

#include "base/identifier.h"
#include <string.h>

static const char *const KEYWORDS[] = {"alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool",
	"break", "case", "catch", "char", "class", "compl", "const", "constexpr", "const_cast", "continue", "decltype",
	"default", "delete", "do", "double", "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float",
	"for", "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq",
	"nullptr", "operator", "or", "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "restrict",
	"return", "short", "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this",
	"thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual", "void",
	"volatile", "wchar_t", "while", "xor", "xor_eq"};

static int is_letter(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static int is_digit(char c)
{
	return c >= '0' && c <= '9';
}

static int is_reserved(const char *s)
{
	for (size_t i = 0; i < sizeof KEYWORDS / sizeof *KEYWORDS; i++)
		if (!strcmp(s, KEYWORDS[i]))
			return 1;
	return s[0] == '_' && (s[1] == '_' || (s[1] >= 'A' && s[1] <= 'Z'));
}

int identifier_is(const char *s)
{
	if (!is_letter(*s) || is_reserved(s))
		return 0;
	for (; *s; s++)
		if (!is_letter(*s) && !is_digit(*s))
			return 0;
	return 1;
}

const char *identifier_from(const char *s, struct arena *a)
{
	static const char prefix[] = "robot_";
	size_t length = strlen(s);
	char *name = arena_alloc(a, sizeof prefix + length, 1), *body;

	if (!name)
		return NULL;
	if (!length)
		return strcpy(name, "robot");
	body = name + sizeof prefix - 1;
	memcpy(name, prefix, sizeof prefix - 1);
	for (size_t i = 0; i < length; i++)
		body[i] = (char)(is_letter(s[i]) || is_digit(s[i]) ? s[i] : '_');
	return identifier_is(body) ? body : name;
}

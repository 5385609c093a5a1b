"""Runs a function block in structured text (IEC 61131-3): as much of the language as `daemon/plc/andon.st` uses.

Every variable has its declared type, and what is assigned to it wraps around as on a controller.
"""

import re

TOKEN = re.compile(r"\(\*.*?\*\)|\s+|(16#[0-9A-Fa-f_]+|\d+)|(:=|<>|<=|>=|\.\.|[-+*/=<>()\[\];:,.])|([A-Za-z_]\w*)", re.S)
WIDTH = {"WORD": 16, "UINT": 16, "UDINT": 32}
# From the weakest to the strongest, as the standard orders them.
BINARY = [["OR"], ["AND"], ["=", "<>"], ["<", ">", "<=", ">="], ["+", "-"], ["*", "/", "MOD"]]
APPLY = {
    "OR": lambda a, b: a | b,
    "AND": lambda a, b: a & b,
    "=": lambda a, b: a == b,
    "<>": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
    "+": lambda a, b: (a + b) & 0xFFFFFFFF,
    "-": lambda a, b: (a - b) & 0xFFFFFFFF,
    "*": lambda a, b: (a * b) & 0xFFFFFFFF,
    "/": lambda a, b: a // b,
    "MOD": lambda a, b: a % b,
}
CONVERSIONS = {"WORD_TO_UDINT": 32, "UDINT_TO_WORD": 16}


def tokens(text):
    at, found = 0, []
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise SyntaxError(f"structured text: {text[at:at + 30]!r}")
        at = match.end()
        if any(match.groups()):
            found.append(match.group(0))
    return found


def number(word):
    return int(word[3:], 16) if word.startswith("16#") else int(word)


class FunctionBlock:
    """An instance: `self.of[name]` is the value of a variable, a list for an array."""

    def __init__(self, text):
        self.tokens, self.at = tokens(text), 0
        self.of, self.types, self.retained, self.constants = {}, {}, [], set()
        self.take("FUNCTION_BLOCK")
        self.name = self.next()
        while self.peek().startswith("VAR"):
            self.declarations()
        self.body = self.statements("END_FUNCTION_BLOCK")

    def call(self):
        """One cycle."""
        for statement in self.body:
            statement()

    # -- reading

    def peek(self):
        return self.tokens[self.at]

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def take(self, expected):
        found = self.next()
        if found != expected:
            raise SyntaxError(f"structured text: {expected} expected, {found} found at token {self.at}")

    def declarations(self):
        self.next()
        is_retained, is_constant = self.peek() == "RETAIN", self.peek() == "CONSTANT"
        if is_retained or is_constant:
            self.next()
        while self.peek() != "END_VAR":
            name = self.next()
            self.take(":")
            kind, count = self.next(), None
            if kind == "ARRAY":
                self.take("["), self.take("0"), self.take("..")
                count = int(self.next()) + 1
                self.take("]"), self.take("OF")
                kind = self.next()
            zero = False if kind == "BOOL" else 0
            if kind not in WIDTH and kind != "BOOL":
                raise SyntaxError(f"structured text: the type {kind}")
            self.types[name] = kind
            self.of[name] = zero if count is None else [zero] * count
            if is_constant:
                self.take(":=")
                self.of[name] = number(self.next())
                self.constants.add(name)
            self.take(";")
            if is_retained:
                self.retained.append(name)
        self.take("END_VAR")

    def statements(self, *ends):
        found = []
        while self.peek() not in ends:
            found.append(self.statement())
        if ends == ("END_FUNCTION_BLOCK",):
            self.next()
        return found

    def statement(self):
        word = self.peek()
        if word in ("IF", "CASE", "FOR"):
            self.next()
            return getattr(self, word.lower() + "_statement")()
        return self.assignment()

    def assignment(self):
        name = self.next()
        kind, index = self.types[name], None
        if name in self.constants:
            raise SyntaxError(f"structured text: {name} is a constant")
        if self.peek() == "[":
            index = self.index()
        self.take(":=")
        value = self.expression()
        self.take(";")

        def fitted():
            result = value()
            if (kind == "BOOL") != isinstance(result, bool):
                raise TypeError(f"structured text: {name} is {kind}, and the value is {result!r}")
            return result if kind == "BOOL" else result & ((1 << WIDTH[kind]) - 1)

        def run():
            if index is None:
                self.of[name] = fitted()
            else:
                self.of[name][index()] = fitted()

        return run

    def index(self):
        self.take("[")
        index = self.expression()
        self.take("]")
        return index

    def if_statement(self):
        branches, otherwise = [], []
        while True:
            condition = self.expression()
            self.take("THEN")
            branches.append((condition, self.statements("ELSIF", "ELSE", "END_IF")))
            word = self.next()
            if word == "ELSE":
                otherwise = self.statements("END_IF")
                word = self.next()
            if word == "END_IF":
                break
        self.take(";")

        def run():
            chosen = next((body for condition, body in branches if condition()), otherwise)
            for statement in chosen:
                statement()

        return run

    def case_statement(self):
        selector = self.expression()
        self.take("OF")
        cases = {}
        while self.peek() != "END_CASE":
            label = int(self.next())
            self.take(":")
            body = []
            while self.peek() != "END_CASE" and self.tokens[self.at + 1] != ":":
                body.append(self.statement())
            cases[label] = body
        self.next(), self.take(";")

        def run():
            for statement in cases[selector()]:
                statement()

        return run

    def for_statement(self):
        name = self.next()
        self.take(":=")
        first = self.expression()
        self.take("TO")
        last = self.expression()
        self.take("DO")
        body = self.statements("END_FOR")
        self.next(), self.take(";")

        def run():
            for value in range(first(), last() + 1):
                self.of[name] = value
                for statement in body:
                    statement()

        return run

    def expression(self, level=0):
        if level == len(BINARY):
            return self.unary()
        left = self.expression(level + 1)
        while self.peek() in BINARY[level]:
            apply, before, after = APPLY[self.next()], left, self.expression(level + 1)
            left = lambda apply=apply, before=before, after=after: apply(before(), after())
        return left

    def unary(self):
        if self.peek() == "NOT":
            self.next()
            value = self.unary()
            return lambda: not value()
        word = self.next()
        if word == "(":
            value = self.expression()
            self.take(")")
            return value
        if word[0].isdigit():
            value = number(word)
            return lambda: value
        if word in ("TRUE", "FALSE"):
            return lambda: word == "TRUE"
        if word in CONVERSIONS:
            self.take("(")
            value, mask = self.expression(), (1 << CONVERSIONS[word]) - 1
            self.take(")")
            return lambda: value() & mask
        if word not in self.types:
            raise SyntaxError(f"structured text: {word} is not declared")
        if self.peek() == "[":
            index = self.index()
            return lambda: self.of[word][index()]
        return lambda: self.of[word]

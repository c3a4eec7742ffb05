//! Xacro's expressions: the part of Python's syntax that such files use, parsed into a tree.

use super::value::Value;

#[derive(Debug, Clone)]
pub(super) enum Expression {
    Value(Value),
    Name(String),
    List(Vec<Expression>),
    Dict(Vec<(Expression, Expression)>),
    Negated(Box<Expression>),
    Not(Box<Expression>),
    Arithmetic(Box<Expression>, &'static str, Box<Expression>),
    /// `a < b <= c`: each neighbour compared.
    Comparison(Box<Expression>, Vec<(&'static str, Expression)>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    /// `then if condition else otherwise`.
    Choice {
        condition: Box<Expression>,
        then: Box<Expression>,
        otherwise: Box<Expression>,
    },
    Attribute(Box<Expression>, String),
    Item(Box<Expression>, Box<Expression>),
    /// A function with its arguments, some of them by name.
    Call(Box<Expression>, Vec<(Option<String>, Expression)>),
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Value(Value),
    Name(String),
    Sign(&'static str),
}

/// Longest first, so that `**` is not read as two.
const SIGNS: [&str; 24] = [
    "**", "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", "{",
    "}", ",", ":", ".", "=", "!",
];
/// Deepest nesting of an expression.
const MOST_NESTED: usize = 64;
/// Longest expression: each sign makes the tree of it deeper.
const MOST_CHARACTERS: usize = 4096;

/// Parses a whole expression.
pub(super) fn parse(text: &str) -> Result<Expression, String> {
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        return Err(format!(
            "has {count} characters, but must have at most {MOST_CHARACTERS}"
        ));
    }
    let mut parser = Parser {
        tokens: tokens(text)?,
        at: 0,
        depth: 0,
    };
    let expression = parser.choice()?;
    match parser.tokens.get(parser.at) {
        None => Ok(expression),
        Some(token) => Err(format!("unexpected {}", shown(token))),
    }
}

/// A number that is written out, with a sign perhaps.
pub(super) fn constant(text: &str) -> Result<f64, String> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    Ok(sign * number(digits)?.number()?)
}

fn shown(token: &Token) -> String {
    match token {
        Token::Value(value) => format!("`{value}`"),
        Token::Name(name) => format!("`{name}`"),
        Token::Sign(sign) => format!("`{sign}`"),
    }
}

fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let follows_digit = rest[first.len_utf8()..].starts_with(|c: char| c.is_ascii_digit());
        let length = if first == '\'' || first == '"' {
            let end = rest[1..].find(first).ok_or("a quote is not closed")?;
            found.push(Token::Value(Value::Text(rest[1..=end].to_owned())));
            end + 2
        } else if first.is_ascii_digit() || (first == '.' && follows_digit) {
            let length = number_length(rest);
            found.push(Token::Value(number(&rest[..length])?));
            length
        } else if first.is_alphabetic() || first == '_' {
            let is_part = |c: char| c.is_alphanumeric() || c == '_';
            let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
            found.push(Token::Name(rest[..length].to_owned()));
            length
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("unexpected `{first}`"))?;
            found.push(Token::Sign(sign));
            sign.len()
        };
        rest = rest[length..].trim_start();
    }
    Ok(found)
}

fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let is_exponent_sign =
            matches!(bytes[at], b'+' | b'-') && at > 0 && matches!(bytes[at - 1], b'e' | b'E');
        if !(bytes[at].is_ascii_alphanumeric() || bytes[at] == b'.' || is_exponent_sign) {
            break;
        }
        at += 1;
    }
    at
}

fn number(text: &str) -> Result<Value, String> {
    if let Ok(value) = text.parse::<i64>() {
        return Ok(Value::Int(value));
    }
    let value = text.parse::<f64>().map(Value::Float);
    value.map_err(|_| format!("`{text}` is not a number"))
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

type Parsed = Result<Expression, String>;

impl Parser {
    fn is_sign(&self, sign: &str) -> bool {
        matches!(self.tokens.get(self.at), Some(Token::Sign(own)) if *own == sign)
    }

    fn take_sign(&mut self, signs: &[&'static str]) -> Option<&'static str> {
        let sign = signs.iter().copied().find(|sign| self.is_sign(sign))?;
        self.at += 1;
        Some(sign)
    }

    fn take_word(&mut self, word: &str) -> bool {
        let is_word = matches!(self.tokens.get(self.at), Some(Token::Name(own)) if own == word);
        self.at += usize::from(is_word);
        is_word
    }

    fn expect(&mut self, sign: &'static str) -> Result<(), String> {
        match self.take_sign(&[sign]) {
            Some(_) => Ok(()),
            None => Err(format!("`{sign}` is missing")),
        }
    }

    fn choice(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(format!("nested more than {MOST_NESTED} deep"));
        }
        let then = self.or()?;
        let chosen = if self.take_word("if") {
            let condition = Box::new(self.or()?);
            if !self.take_word("else") {
                return Err("`else` is missing after `if`".to_owned());
            }
            Expression::Choice {
                condition,
                then: Box::new(then),
                otherwise: Box::new(self.choice()?),
            }
        } else {
            then
        };
        self.depth -= 1;
        Ok(chosen)
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        while self.take_word("or") {
            left = Expression::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.not()?;
        while self.take_word("and") {
            left = Expression::And(Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> Parsed {
        let mut count = 0;
        while self.take_word("not") {
            count += 1;
        }
        let mut value = self.comparison()?;
        for _ in 0..count {
            value = Expression::Not(Box::new(value));
        }
        Ok(value)
    }

    fn comparison(&mut self) -> Parsed {
        let first = self.sum()?;
        let mut others = Vec::new();
        loop {
            let op = if self.take_word("in") {
                "in"
            } else if self.take_word("not") {
                if !self.take_word("in") {
                    return Err("`in` is missing after `not`".to_owned());
                }
                "not in"
            } else if let Some(sign) = self.take_sign(&["==", "!=", "<=", ">=", "<", ">"]) {
                sign
            } else {
                break;
            };
            others.push((op, self.sum()?));
        }
        Ok(if others.is_empty() {
            first
        } else {
            Expression::Comparison(Box::new(first), others)
        })
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        while let Some(sign) = self.take_sign(&["+", "-"]) {
            left = Expression::Arithmetic(Box::new(left), sign, Box::new(self.product()?));
        }
        Ok(left)
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.signed()?;
        while let Some(sign) = self.take_sign(&["*", "//", "/", "%"]) {
            left = Expression::Arithmetic(Box::new(left), sign, Box::new(self.signed()?));
        }
        Ok(left)
    }

    fn signed(&mut self) -> Parsed {
        let mut is_negative = false;
        while let Some(sign) = self.take_sign(&["+", "-"]) {
            is_negative ^= sign == "-";
        }
        let power = self.power()?;
        Ok(if is_negative {
            Expression::Negated(Box::new(power))
        } else {
            power
        })
    }

    fn power(&mut self) -> Parsed {
        let base = self.postfix()?;
        if self.take_sign(&["**"]).is_none() {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(format!("nested more than {MOST_NESTED} deep"));
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(Expression::Arithmetic(
            Box::new(base),
            "**",
            Box::new(exponent),
        ))
    }

    fn postfix(&mut self) -> Parsed {
        let mut value = self.atom()?;
        while let Some(sign) = self.take_sign(&[".", "[", "("]) {
            value = match sign {
                "." => match self.tokens.get(self.at) {
                    Some(Token::Name(name)) => {
                        let name = name.clone();
                        self.at += 1;
                        Expression::Attribute(Box::new(value), name)
                    }
                    _ => return Err("a name is missing after `.`".to_owned()),
                },
                "[" => {
                    let key = self.choice()?;
                    self.expect("]")?;
                    Expression::Item(Box::new(value), Box::new(key))
                }
                _ => Expression::Call(Box::new(value), self.arguments()?),
            };
        }
        Ok(value)
    }

    /// Expressions with commas between them, up to the closing sign.
    fn listed(&mut self, close: &'static str) -> Result<Vec<Expression>, String> {
        let mut values = Vec::new();
        while self.take_sign(&[close]).is_none() {
            values.push(self.choice()?);
            if self.take_sign(&[","]).is_none() {
                self.expect(close)?;
                break;
            }
        }
        Ok(values)
    }

    /// The arguments of a call, up to its closing bracket.
    fn arguments(&mut self) -> Result<Vec<(Option<String>, Expression)>, String> {
        let mut given = Vec::new();
        while self.take_sign(&[")"]).is_none() {
            let named = match (self.tokens.get(self.at), self.tokens.get(self.at + 1)) {
                (Some(Token::Name(name)), Some(Token::Sign("="))) => Some(name.clone()),
                _ => None,
            };
            self.at += if named.is_some() { 2 } else { 0 };
            given.push((named, self.choice()?));
            if self.take_sign(&[","]).is_none() {
                self.expect(")")?;
                break;
            }
        }
        Ok(given)
    }

    fn atom(&mut self) -> Parsed {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        match token {
            Some(Token::Value(value)) => Ok(Expression::Value(value)),
            Some(Token::Name(name)) => Ok(Expression::Name(name)),
            Some(Token::Sign("(")) => self.in_brackets(),
            Some(Token::Sign("[")) => Ok(Expression::List(self.listed("]")?)),
            Some(Token::Sign("{")) => {
                let mut entries = Vec::new();
                while self.take_sign(&["}"]).is_none() {
                    let key = self.choice()?;
                    self.expect(":")?;
                    entries.push((key, self.choice()?));
                    if self.take_sign(&[","]).is_none() {
                        self.expect("}")?;
                        break;
                    }
                }
                Ok(Expression::Dict(entries))
            }
            Some(other) => Err(format!("unexpected {}", shown(&other))),
            None => Err("the expression ends too early".to_owned()),
        }
    }

    /// A value in brackets, or several: a tuple, which is taken as a list.
    fn in_brackets(&mut self) -> Parsed {
        if self.take_sign(&[")"]).is_some() {
            return Ok(Expression::List(Vec::new()));
        }
        let first = self.choice()?;
        if self.take_sign(&[","]).is_none() {
            self.expect(")")?;
            return Ok(first);
        }
        let mut values = vec![first];
        values.extend(self.listed(")")?);
        Ok(Expression::List(values))
    }
}

//! Car parks told by their spaces: "all of the twelve parking spaces are occupied by cars" is twelve parked cars in a car park.

use super::ellipsis::{is_noun, number};
use super::tokens::Token;
use super::wording::{begins, rewritten, word};

/// A prompt in which full spaces are what stands in them.
pub fn filled(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = "all of the|all the|all|each of the|the";
    const SPACES: &str = "parking spaces|parking bays|parking spots|parking slots|parking places|spaces|bays|spots|slots|parking boxes|marked spaces|marked bays";
    const FULL: &str = "are occupied by|are taken by|are filled by|are filled with|are occupied with|are used by|are full of|are all occupied by|are all taken by|hold|contain|have";
    rewritten(tokens, |i, out| {
        let lead = begins(&tokens[i..], LEAD).unwrap_or(0);
        let k = tokens
            .get(i + lead)
            .and_then(number)
            .filter(|n| *n > 1)
            .and_then(|_| {
                let mut k = i + lead + 1;
                k += begins(tokens.get(k..)?, SPACES)?;
                k += begins(
                    tokens.get(k..)?,
                    "of the car park|of the parking lot|of the lot|in the car park|in the parking lot|here",
                )
                .unwrap_or(0);
                k += begins(tokens.get(k..)?, FULL)?;
                tokens.get(k).filter(|t| is_noun(t))?;
                Some(k)
            })?;
        out.extend([
            tokens[i + lead].clone(),
            word("parked", &tokens[i]),
            tokens[k].clone(),
        ]);
        out.extend(["are", "in", "the", "car", "park"].map(|w| word(w, &tokens[i])));
        Some(k + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn full_spaces_are_parked_cars() {
        let said = |t: &str| {
            let list: Vec<String> = filled(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("All of the twelve parking spaces are occupied by cars, and a bus waits"),
            "twelve parked cars are in the car park , and a bus waits"
        );
        assert_eq!(
            said("three parking spaces are free"),
            "three parking spaces are free"
        );
    }
}

// Numbers and sentences. The words of the verdicts are those of docs/notation.md.

/** What each verdict says of the hand as it stands. */
export const MEANINGS = {
  target: "Closing from here can end only in the target grasp.",
  caged: "The object cannot leave, but closing may end in another grasp.",
  other: "The object cannot leave, but the target is not within reach without opening further.",
  escapes: "The object can leave without the hand opening any further.",
};

/** What is said of a hand where the contacts are no cage. */
export const NO_CAGE = "These contacts hold nothing, and what else might hold the object was not asked.";

/** What a collision says: which fingers. */
export function collisionWords(fingers) {
  if (fingers.length === 1) return `Finger ${fingers[0]} stands inside the object.`;
  return `Fingers ${listed(fingers)} stand inside the object.`;
}

/** "1, 2 and 3" */
export function listed(things) {
  const words = things.map(String);
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} and ${words.at(-1)}`;
}

/**
 * A function that writes lengths, with so many decimals that the levels can be told apart, and
 * more for one that would be written as zero.
 */
export function lengthWriter(diameter, levels) {
  const size = Math.floor(Math.log10(diameter));
  const plain = size >= -3 && size <= 6;
  const apart = levels.flatMap((a) => levels.map((b) => Math.abs(a - b)))
    .filter((gap) => gap > 1e-8 * diameter);
  const least = Math.min(diameter, ...apart);
  const usual = 4 - size;
  const digits = Math.max(0, Math.min(usual + 4, Math.max(usual, Math.ceil(-Math.log10(least)))));
  const resolved = 10 ** -digits;
  return (value) => {
    if (value === 0) return "0";
    if (!plain) return value.toExponential(5);
    if (Math.abs(value) < 0.5 * resolved) return withoutExponent(value);
    return value.toFixed(digits);
  };
}

function withoutExponent(value) {
  const text = value.toPrecision(2);
  return text.includes("e") ? `${text.replace("e", " × 10^").replace("^-", "^−")}` : text;
}

/** A ratio with four decimals. */
export function ratio(value) {
  return value.toFixed(4);
}

/** Degrees of an angle in radians. */
export function degrees(angle) {
  return (180 / Math.PI) * angle;
}

export function radians(angle) {
  return (Math.PI / 180) * angle;
}

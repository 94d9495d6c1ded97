// Words of the parts that all pages share, which a page may have in another language.

export const WORDS = {
  play: "Play",
  pause: "Pause",
  speed: "Speed",
  turnIn: (seconds: number) => `a turn in ${seconds} s`,
  angle: "Cam angle",
  inDegrees: "Cam angle in degrees",
  degrees: (degrees: string) => `${degrees} degrees`,
  state: (degrees: string, lift: string) => `Cam angle ${degrees}°${lift && `, follower at ${lift}`}`,
  mechanism: "The mechanism at the cam angle stated below",
  diagram: "Diagram",
  extremes: "Extremes as a table",
  extremesOf: ["curve", "smallest", "at", "largest", "at"],
  noWebGL: "This browser has no WebGL, so the solid is not drawn.",
};

export type Words = typeof WORDS;

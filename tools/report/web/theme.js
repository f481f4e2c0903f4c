"use strict";
// Everything the page's scripts share hangs on this one name.
const carom = {};

// Light or dark as the system says, and one palette for each. Colours after Okabe and Ito (2008), which readers with
// colour-blindness can tell apart; darkened or lightened until they stand out from the ground.
carom.theme = (() => {
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const palettes = {
    light: ["#0072b2", "#c2410c", "#00815f", "#b5568f", "#a06a00", "#2a8fd0", "#5b3fa0", "#5b5b5b"],
    dark: ["#56b4e9", "#ff8c42", "#2bd4a4", "#f0a3cb", "#f0c642", "#a5d8ff", "#c3a6ff", "#b8b8b8"],
  };
  return {
    isDark: () => dark.matches,
    palette: () => (dark.matches ? palettes.dark : palettes.light),
    colour: (index) => {
      const palette = dark.matches ? palettes.dark : palettes.light;
      return palette[index % palette.length];
    },
    /** A colour of page.css by its name, such as "--text". */
    named: (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim(),
    onChange: (listener) => dark.addEventListener("change", listener),
  };
})();

/** Formats numbers, sizes, times and file names. */

const counts = new Intl.NumberFormat("en");
const shares = new Intl.NumberFormat("en", { style: "percent", maximumFractionDigits: 1 });
const values = new Intl.NumberFormat("en", { maximumSignificantDigits: 3 });
const ago = new Intl.RelativeTimeFormat("en", { numeric: "auto", style: "short" });
const UNITS: [Intl.RelativeTimeFormatUnit, number][] = [
  ["day", 86_400],
  ["hour", 3600],
  ["minute", 60],
];

export const count = (value: number): string => counts.format(value);
export const share = (value: number): string => shares.format(value);
export const figure = (value: number | null): string => (value === null ? "–" : values.format(value));
export const plural = (n: number, one: string, many = `${one}s`): string => `${count(n)} ${n === 1 ? one : many}`;

export function bytes(size: number): string {
  const step = Math.min(Math.max(Math.floor(Math.log2(Math.max(size, 1)) / 10), 0), 3);
  return `${values.format(size / 1024 ** step)} ${["B", "KB", "MB", "GB"][step]}`;
}

export function when(time: string): string {
  const seconds = (Date.parse(time) - Date.now()) / 1000;
  const [unit, length] = UNITS.find(([, length]) => -seconds >= length) ?? ["second", 1];
  return unit === "second" ? "just now" : ago.format(Math.round(seconds / length), unit);
}

export const capitalized = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

/** Return a file name without its folder and extension. */
export function stem(fileName: string): string {
  return fileName.replace(/^.*[\\/]/, "").replace(/(\.gz)?$/i, "").replace(/\.[a-z0-9]{2,5}$/i, "") || "mesh";
}

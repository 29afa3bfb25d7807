/** The drawer of parameters, built from the JSON Schema of GET /v1/methods. */

import { getMethods, type Parameter } from "./api";
import { byId, h, openDialog, toast } from "./dom";
import { explain, problemOf } from "./problems";

export interface Run {
  readonly parameters: Readonly<Record<string, unknown>>;
  /** The number of parts to show; null for the automatic number. */
  readonly segments: number | null;
  readonly isBeside: boolean;
}

export class ParameterDrawer {
  readonly #dialog = byId<HTMLDialogElement>("parameters");
  readonly #fields = new Map<string, { schema: Parameter; input: HTMLInputElement | HTMLSelectElement }>();
  readonly #onRun: (run: Run) => void;

  constructor(onRun: (run: Run) => void) {
    this.#onRun = onRun;
    byId("parameters-form").addEventListener("submit", (event) => this.#submit(event as SubmitEvent));
    byId("parameters-reset").addEventListener("click", () => this.#fill({}));
    byId("want").addEventListener("change", () => this.#showNumber());
  }

  /** Open the drawer with the present values; ``hasResult`` enables a comparison with the shown result. */
  async open(present: Readonly<Record<string, unknown>>, hasResult: boolean): Promise<void> {
    try {
      if (this.#fields.size === 0) this.#build((await getMethods()).properties);
    } catch (error) {
      const { title, next } = explain(problemOf(error));
      return toast(`${title}. ${next}`);
    }
    this.#fill(present);
    byId("run-beside-row").hidden = !hasResult;
    openDialog(this.#dialog);
  }

  #build(properties: Record<string, Parameter>): void {
    for (const [name, schema] of Object.entries(properties)) {
      const input = fieldFor(name, schema);
      this.#fields.set(name, { schema, input });
      const row = h(
        "div",
        { className: "field" },
        h("label", { htmlFor: input.id }, schema.title ?? name, schema["x-advanced"] === true && h("code", {}, name)),
        input,
        h("p", { id: `${input.id}-about`, className: "about" }, schema["x-about"] ?? schema.description ?? ""),
      );
      input.setAttribute("aria-describedby", `${input.id}-about`);
      byId(schema["x-advanced"] === true ? "more-parameters" : "usual-parameters").append(row);
    }
  }

  #fill(present: Readonly<Record<string, unknown>>): void {
    for (const [name, { schema, input }] of this.#fields) {
      const value = name in present ? present[name] : schema.default;
      input.value = value === null || value === undefined ? "" : String(value);
    }
    this.#showNumber();
  }

  #showNumber(): void {
    byId("want-number-row").hidden = byId<HTMLSelectElement>("want").value === "automatic";
  }

  #submit(event: SubmitEvent): void {
    const parameters: Record<string, unknown> = {};
    for (const [name, { schema, input }] of this.#fields) {
      const value = valueOf(input, schema);
      if (value !== (schema.default ?? null)) parameters[name] = value;
    }
    const isAutomatic = byId<HTMLSelectElement>("want").value === "automatic";
    const segments = isAutomatic ? null : byId<HTMLInputElement>("want-number").valueAsNumber;
    const isBeside = (event.submitter as HTMLButtonElement | null)?.value === "beside";
    this.#onRun({ parameters, segments, isBeside });
  }
}

/** Return a schema merged with its first alternative that is not null. */
function core(schema: Parameter): Parameter {
  return { ...schema, ...schema.anyOf?.find(({ type }) => type !== "null") };
}

function choicesOf(schema: Parameter): unknown[] | undefined {
  if (schema.enum !== undefined) return schema.enum;
  const constants = schema.anyOf?.filter((option) => "const" in option).map((option) => option.const);
  return constants !== undefined && constants.length > 1 ? constants : undefined;
}

function typesOf(schema: Parameter): string[] {
  const { type } = core(schema);
  return type === undefined ? [] : Array.isArray(type) ? type : [type];
}

function fieldFor(name: string, schema: Parameter): HTMLInputElement | HTMLSelectElement {
  const id = `parameter-${name}`;
  const choices = choicesOf(schema);
  if (choices !== undefined)
    return h(
      "select",
      { id },
      schema.default === undefined && h("option", { value: "" }, "None"),
      ...choices.map((choice) => h("option", { value: String(choice) }, schema["x-choices"]?.[String(choice)] ?? String(choice))),
    );
  const { minimum, maximum } = core(schema);
  const isWhole = typesOf(schema).includes("integer");
  const input = h("input", { id, type: "number", step: isWhole ? "1" : "any", placeholder: "automatic" });
  // With alternatives, the limits belong to one of them only; the service checks the value.
  if (schema.anyOf === undefined) {
    if (minimum !== undefined) input.min = String(minimum);
    if (maximum !== undefined) input.max = String(maximum);
    input.required = schema.default !== null;
  }
  return input;
}

function valueOf(input: HTMLInputElement | HTMLSelectElement, schema: Parameter): unknown {
  if (input.value === "") return null;
  const choices = choicesOf(schema);
  if (choices !== undefined) return choices.find((choice) => String(choice) === input.value);
  return Number(input.value);
}

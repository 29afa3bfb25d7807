/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */
import{b as a}from"./viewer-2.js";import"./viewer.js";export{a as CleaveViewer};

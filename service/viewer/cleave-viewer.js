/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */
import{a}from"./viewer.js";export{a as CleaveViewer};
